# Writes the header HEADER from TEMPLATE if its content changes. BUILD_COMMIT is the commit of
# SOURCES, followed by "+" if files differ from it, or "unknown" without git.
cmake_minimum_required(VERSION 3.25)
set(BUILD_COMMIT unknown)
find_program(git git)
if(git)
  execute_process(COMMAND ${git} -C ${SOURCES} describe --always --abbrev=12 --dirty=+ --exclude=*
                  OUTPUT_VARIABLE commit RESULT_VARIABLE failure OUTPUT_STRIP_TRAILING_WHITESPACE
                  ERROR_QUIET)
  if(NOT failure)
    set(BUILD_COMMIT ${commit})
  endif()
endif()
configure_file(${TEMPLATE} ${HEADER} @ONLY)
