# The Debian packages that `cpack` makes, one of each component that is installed: the program, and
# the libraries for development. tests/checks/packages tries them in a bare root.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_CONTACT "Skycap maintainers <maintainers@skycap.invalid>")
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_THREADS 0)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_COMPONENTS_ALL program development)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)

set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME skycap)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SUGGESTS "gnuplot-nox, npm")
set(CPACK_COMPONENT_PROGRAM_DESCRIPTION "plans and simulates aerial surveys of buildings
 Decides where to look from next by the points measured so far, proves that
 every leg keeps its distance, and writes the flight for autopilots.")

# Static libraries: who links one needs what it was made with. Planners need the first list alone.
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME libskycap-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
string(JOIN ", " CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS libdraco-dev libeigen3-dev libgmp-dev
  libmpfr-dev libnlopt-dev zlib1g-dev)
string(JOIN ", " CPACK_DEBIAN_DEVELOPMENT_PACKAGE_RECOMMENDS libceres-dev libembree-dev libfmt-dev
  libgeographiclib-dev libompl-dev libpng-dev libpugixml-dev libssl-dev libyaml-cpp-dev libzip-dev)
set(CPACK_COMPONENT_DEVELOPMENT_DESCRIPTION "libraries of Skycap, for aerial surveys of buildings
 Planners, proofs of clearance, simulated sensors, and files that CMake finds
 them by. What the components beyond survey are linked with is recommended.")

include(CPack)

# What every package of Debian's has beside its files.
foreach(pair IN ITEMS program:skycap development:libskycap-dev)
  string(REGEX MATCH "(.*):(.*)" pair ${pair})
  install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${CMAKE_MATCH_2}
    RENAME copyright COMPONENT ${CMAKE_MATCH_1})
endforeach()
