# Debian packages created by `cpack`, one per install component: the program, the development
# libraries, and the Python module if it is built. tests/checks/packages tests them in a minimal root.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_CONTACT "Skycap maintainers <maintainers@skycap.invalid>")
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_THREADS 0)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_COMPONENTS_ALL program development)
set(packages program:skycap development:libskycap-dev)
if(TARGET skycap_python)
  list(APPEND CPACK_COMPONENTS_ALL python)
  list(APPEND packages python:python3-skycap)
endif()
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)

set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME skycap)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SUGGESTS "npm")
set(CPACK_COMPONENT_PROGRAM_DESCRIPTION "plans and simulates aerial surveys of buildings
Selects the next view from the points measured so far, verifies the clearance
of every leg, and writes missions for autopilots.")

# Dependencies of programs that link the static libraries. Planners need only the first list.
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME libskycap-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
string(JOIN ", " CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS libdraco-dev libeigen3-dev libgmp-dev
  libmpfr-dev libnlopt-dev zlib1g-dev)
string(JOIN ", " CPACK_DEBIAN_DEVELOPMENT_PACKAGE_RECOMMENDS libceres-dev libembree-dev libfmt-dev
  libgeographiclib-dev libompl-dev libpng-dev libpugixml-dev libssl-dev libyaml-cpp-dev libzip-dev)
set(CPACK_COMPONENT_DEVELOPMENT_DESCRIPTION "libraries of Skycap, for aerial surveys of buildings
Planners, clearance verification and simulated sensors, with files for CMake's
find_package. Packages for components other than survey are recommended.")

# A module supports exactly one minor version of the Python interpreter.
if(TARGET skycap_python)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-skycap)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_RECOMMENDS skycap)  # its plug-ins read maps and city models
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SHLIBDEPS ON)
  string(JOIN ", " CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS python3-numpy
    "python3 (>= ${python_version})" "python3 (<< ${next_python_version})")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_EXTRA
    ${CMAKE_CURRENT_SOURCE_DIR}/python3-skycap/postinst
    ${CMAKE_CURRENT_SOURCE_DIR}/python3-skycap/prerm)
  set(CPACK_COMPONENT_PYTHON_DESCRIPTION "aerial surveys of buildings, from Python
Planners on NumPy arrays, simulated surveys, laser scans in parts, clearance
verification, and the evaluation of point clouds.")
endif()

include(CPack)

# Copyright and changelog, which are required in every Debian package.
configure_file(changelog.in changelog @ONLY)
execute_process(COMMAND gzip -9nkf changelog WORKING_DIRECTORY ${CMAKE_CURRENT_BINARY_DIR}
                COMMAND_ERROR_IS_FATAL ANY)
foreach(pair IN LISTS packages)
  string(REGEX MATCH "(.*):(.*)" pair ${pair})
  install(FILES copyright ${CMAKE_CURRENT_BINARY_DIR}/changelog.gz
    DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${CMAKE_MATCH_2} COMPONENT ${CMAKE_MATCH_1})
endforeach()
