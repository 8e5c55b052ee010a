# Checks that results are the same everywhere. Fails with the names of the files if results depend
# on the processor, the number of threads, the C library's function variants, or the folder. Also
# fails if surveys differ from those in everywhere.sha256, which was written on another machine. Run
# by ctest with PROGRAM, MISSIONS and FOLDER, on shortened shipped missions. A change that
# intentionally changes surveys must say so and update the checksums: -D RENEW=ON.
cmake_minimum_required(VERSION 3.25)

set(quick
  "plan teapot.yaml --max-views 4 @options@ @folder@/see++"
  "plan teapot.yaml --planner see --max-views 4 @options@ @folder@/see"
  "plan teapot.yaml --planner skycap --max-views 4 @options@ @folder@/skycap"
  "plan teapot.yaml --planner rsv --max-views 2 @options@ @folder@/rsv"
  "model city-block --out @folder@/models/city_block.ply"
  "model radcliffe-camera --out @folder@/models/radcliffe_camera.ply"
  "scan radcliffe_camera_lidar.yaml --set scan.orbit.circles=1 --set scan.orbit.speed=100 @options@ @folder@/scan")
set(slow "plan radcliffe_camera.yaml --max-views 3 @options@ @folder@/building")

function(survey folder)
  cmake_parse_arguments(PARSE_ARGV 1 under "" "THREADS" "MISSIONS;ENVIRONMENT")
  set(run ${CMAKE_COMMAND} -E env ${under_ENVIRONMENT} ${PROGRAM})
  set(options --threads ${under_THREADS} --quiet --out)
  file(REMOVE_RECURSE ${folder})
  file(MAKE_DIRECTORY ${folder}/models)
  foreach(command IN LISTS under_MISSIONS)
    string(CONFIGURE "${command}" command @ONLY)
    separate_arguments(command)
    execute_process(COMMAND ${run} ${command} WORKING_DIRECTORY ${MISSIONS} OUTPUT_QUIET
                    RESULT_VARIABLE result ERROR_VARIABLE errors)
    if(NOT result EQUAL 0)
      message(FATAL_ERROR "skycap ${command}: ${errors}")
    endif()
  endforeach()
endfunction()

set(reference ${FOLDER}/reference)
survey(${reference} THREADS 1 MISSIONS ${quick} ${slow} ENVIRONMENT SKYCAP_INSTRUCTION_SET=baseline)

# summary.json and scan.json contain durations and the number of threads.
file(GLOB_RECURSE results RELATIVE ${reference} ${reference}/*.csv ${reference}/*.ply
     ${reference}/*.las ${reference}/*.tum)
list(SORT results)

# Of surveys, only decisions and measurements are compared. Routes have their own tests.
set(sums "")
foreach(file IN LISTS results)
  if(file MATCHES "/(views\\.csv|cloud\\.ply|.*\\.las)$|^models/")
    file(SHA256 ${reference}/${file} sum)
    string(APPEND sums "${sum}  ${file}\n")
  endif()
endforeach()
set(sums_file ${CMAKE_CURRENT_LIST_DIR}/everywhere.sha256)
if(RENEW)
  file(WRITE ${sums_file} "${sums}")
endif()
file(READ ${sums_file} expected_sums)
if(NOT sums STREQUAL expected_sums)
  message(SEND_ERROR "not as everywhere.sha256 says:\n${sums}")
endif()

function(expect_same name)
  set(other ${FOLDER}/${name})
  survey(${other} ${ARGN})
  file(GLOB_RECURSE others RELATIVE ${other} ${other}/*.csv ${other}/*.ply ${other}/*.las
       ${other}/*.tum)
  if(NOT others)
    message(FATAL_ERROR "${name}: nothing was written")
  endif()
  foreach(file IN LISTS others)
    file(SHA256 ${reference}/${file} expected)
    file(SHA256 ${other}/${file} found)
    if(NOT found STREQUAL expected)
      message(SEND_ERROR "${name}: ${file} is another one")
    endif()
  endforeach()
endfunction()

expect_same(avx2 THREADS 2 MISSIONS ${quick} ENVIRONMENT SKYCAP_INSTRUCTION_SET=avx2)
expect_same(avx512 THREADS 4 MISSIONS ${quick} ${slow} ENVIRONMENT SKYCAP_INSTRUCTION_SET=avx512)
expect_same(no_fma THREADS 2 MISSIONS ${quick} ENVIRONMENT GLIBC_TUNABLES=glibc.cpu.hwcaps=-AVX2,-FMA,-AVX512F
            LC_ALL=C TZ=Asia/Tokyo)
file(REMOVE_RECURSE ${FOLDER})
