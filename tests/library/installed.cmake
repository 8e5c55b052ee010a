# Checks that the result of `cmake --install` can be moved, linked and run. Installs BUILD into
# FOLDER, moves it, builds each example against the required component only, and runs it. Compiles
# each public header on its own and runs its example. Run by ctest with BUILD, SOURCE, FOLDER,
# GENERATOR and COMPILER.
function(run result)
  execute_process(COMMAND ${ARGN} WORKING_DIRECTORY ${FOLDER}
    RESULT_VARIABLE code OUTPUT_VARIABLE output ERROR_VARIABLE errors)
  if(NOT code EQUAL 0)
    list(JOIN ARGN " " command)
    message(FATAL_ERROR "${command}: ${code}\n${output}${errors}")
  endif()
  set(${result} "${output}" PARENT_SCOPE)
endfunction()

file(REMOVE_RECURSE ${FOLDER})
file(MAKE_DIRECTORY ${FOLDER})
run(log ${CMAKE_COMMAND} --install ${BUILD} --prefix ${FOLDER}/installed)
file(RENAME ${FOLDER}/installed ${FOLDER}/moved)
set(skycap ${FOLDER}/moved/bin/skycap)

# Builds the project in a folder. find_package() calls for the packages in `absent` fail.
function(build_against_installed name source)
  set(absent "")
  foreach(package IN LISTS ARGN)
    list(APPEND absent -D CMAKE_DISABLE_FIND_PACKAGE_${package}=TRUE)
  endforeach()
  run(log ${CMAKE_COMMAND} -S ${source} -B ${FOLDER}/${name} -G ${GENERATOR}
    -D CMAKE_CXX_COMPILER=${COMPILER} -D CMAKE_EXPORT_COMPILE_COMMANDS=ON
    -D CMAKE_PREFIX_PATH=${FOLDER}/moved ${absent})
  run(log ${CMAKE_COMMAND} --build ${FOLDER}/${name} --parallel 2)
  file(READ ${FOLDER}/${name}/compile_commands.json commands)
  if(commands MATCHES " (-W[a-z]|-DCGAL|-DSKYCAP|-fno-builtin|-include |-ffp-contract)[^ ]*")
    message(SEND_ERROR "${name}: the libraries have their users compile with${CMAKE_MATCH_0}")
  endif()
endfunction()

function(expect_output name pattern)
  run(output ${FOLDER}/${name}/${name} ${ARGN})
  if(NOT output MATCHES "${pattern}")
    message(SEND_ERROR "${name} prints\n${output}in place of ${pattern}")
  endif()
endfunction()

set(heavy PCL MRPT mrpt-maps ompl CGAL OpenSSL fmt yaml-cpp CLI11 nlohmann_json)
build_against_installed(own_sensor ${SOURCE}/examples/own_sensor ${heavy} Ceres embree)
expect_output(own_sensor "views, [0-9]+ points, (9[0-9]|100)[.][0-9] % estimated coverage\n$")
build_against_installed(certify_route ${SOURCE}/examples/certify_route ${heavy} embree)
# Only the third leg violates the clearance: it crosses the roof, which is 30 m high, at 31 m.
expect_output(certify_route "^leg 2: 1[.]000 m from [^\n]*\n3 of 4 legs have a clearance of at least 2 m\n$")
build_against_installed(simulate_lidar ${SOURCE}/examples/simulate_lidar ${heavy} Ceres)
expect_output(simulate_lidar "^[1-9][0-9]* returns from 80000 pulses\n$")
build_against_installed(own_planner ${SOURCE}/examples/own_planner ${heavy} embree)

# Compiles each public header on its own.
file(GLOB headers RELATIVE ${FOLDER}/moved/include ${FOLDER}/moved/include/skycap/*/*.h)
foreach(header IN LISTS headers)
  string(MAKE_C_IDENTIFIER ${header} name)
  file(WRITE ${FOLDER}/alone/${name}.cpp "#include <${header}>\n#include <${header}>\n")
endforeach()
file(WRITE ${FOLDER}/alone/former_names.cpp "
#include <skycap/former_names.h>

#include <skycap/survey/survey_loop.h>
#include <skycap/survey/surfel_planner.h>
static_assert(sizeof(skycap::survey::skycap::SkycapPlanner) > 0);
skycap::survey::SurveyPorts ports;
")
file(WRITE ${FOLDER}/alone/CMakeLists.txt "
  cmake_minimum_required(VERSION 3.25)
  project(headers LANGUAGES CXX)
  find_package(Skycap 0.2 REQUIRED COMPONENTS geometry sim survey flight missions)
  file(GLOB sources *.cpp)
  add_library(headers OBJECT \${sources})
  target_link_libraries(headers PRIVATE Skycap::missions)
")
build_against_installed(headers_alone ${FOLDER}/alone)

# Each public header has an example, whose output must match its comment.
foreach(header IN LISTS headers)
  string(REGEX REPLACE "^skycap/(.+)[.]h$" "${SOURCE}/examples/headers/\\1.cpp" example ${header})
  if(NOT EXISTS ${example})
    message(SEND_ERROR "there is no example of <${header}>: ${example}")
  endif()
endforeach()
build_against_installed(headers ${SOURCE}/examples/headers)
list(LENGTH headers count)
expect_output(headers "^${count} of ${count} examples passed\n$")

# No file contains the build folder, and the program finds its plug-ins.
file(GLOB_RECURSE files ${FOLDER}/moved/include/* ${FOLDER}/moved/*.cmake)
foreach(file IN LISTS files)
  file(READ ${file} text)
  string(FIND "${text}" ${SOURCE} place)
  if(NOT place EQUAL -1)
    message(SEND_ERROR "${file} names ${SOURCE}")
  endif()
endforeach()
run(log ${skycap} model teapot --out ${FOLDER}/teapot.ply)
run(log ${CMAKE_COMMAND} -E env --unset=SKYCAP_PLUGINS ${skycap} reconstruct ${FOLDER}/teapot.ply)
file(REMOVE_RECURSE ${FOLDER})
