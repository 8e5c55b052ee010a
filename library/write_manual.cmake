# Writes the manual page of PROGRAM, from what it says of itself, to PAGE, compressed.
cmake_minimum_required(VERSION 3.25)
function(ask result)
  execute_process(COMMAND ${PROGRAM} ${ARGN} --help OUTPUT_VARIABLE text
                  COMMAND_ERROR_IS_FATAL ANY)
  string(REGEX REPLACE "\\\\" "\\\\\\\\" text "${text}")   # roff's own characters
  string(REGEX REPLACE "-" "\\\\-" text "${text}")
  string(REGEX REPLACE "(^|\n)([.'])" "\\1\\\\&\\2" text "${text}")
  set(${result} ".nf\n${text}.fi\n" PARENT_SCOPE)
endfunction()

execute_process(COMMAND ${PROGRAM} --help OUTPUT_VARIABLE help COMMAND_ERROR_IS_FATAL ANY)
string(FIND "${help}" "Subcommands" place)
string(SUBSTRING "${help}" ${place} -1 list)
string(REGEX MATCHALL "\n  [a-z-]+ " verbs "${list}")
ask(overview)
set(page ".TH SKYCAP 1 \"\" \"Skycap ${VERSION}\" \"User Commands\"
.SH NAME
skycap \\- plan, simulate and export aerial surveys of buildings
.SH SYNOPSIS
.B skycap
.I VERB
[\\fIOPTIONS\\fR]
.SH DESCRIPTION
${overview}")
foreach(verb IN LISTS verbs)
  string(STRIP "${verb}" verb)
  ask(text ${verb})
  string(APPEND page ".SH \"SKYCAP ${verb}\"\n${text}")
endforeach()
string(APPEND page ".SH ENVIRONMENT
.TP
.B SKYCAP_MODELS
folder in which model:NAME is looked for first
.TP
.B SKYCAP_PLUGINS
folder of the plug-ins, where they are not with the program
.SH EXIT STATUS
.TP
.B 0
done
.TP
.B 1
negative result, incomplete or interrupted
.TP
.B 2
bad input
.TP
.B 3
failed
.TP
.B 10, 11, 12
skycap next: the survey is over; no view is left; the scan is rejected
.TP
.B 143
a task was ended by SIGTERM
")
string(REGEX REPLACE "\\.gz$" "" plain ${PAGE})
file(WRITE ${plain} "${page}")
execute_process(COMMAND gzip -9nf ${plain} COMMAND_ERROR_IS_FATAL ANY)
