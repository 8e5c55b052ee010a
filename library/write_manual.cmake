# Writes the compressed manual page PAGE from the help text of PROGRAM.
cmake_minimum_required(VERSION 3.25)
function(ask result)
  execute_process(COMMAND ${PROGRAM} ${ARGN} --help OUTPUT_VARIABLE text
                  COMMAND_ERROR_IS_FATAL ANY)
  string(REGEX REPLACE "\\\\" "\\\\\\\\" text "${text}")   # escapes roff's special characters
  string(REGEX REPLACE "-" "\\\\-" text "${text}")
  string(REGEX REPLACE "(^|\n)([.'])" "\\1\\\\&\\2" text "${text}")
  set(${result} ".nf\n${text}.fi\n" PARENT_SCOPE)
endfunction()

execute_process(COMMAND ${PROGRAM} --help OUTPUT_VARIABLE help COMMAND_ERROR_IS_FATAL ANY)
string(FIND "${help}" "Subcommands" place)
string(SUBSTRING "${help}" ${place} -1 list)
string(REGEX MATCHALL "\n  [a-z-]+ " commands "${list}")
ask(overview)
set(page ".TH SKYCAP 1 \"\" \"Skycap ${VERSION}\" \"User Commands\"
.SH NAME
skycap \\- plan, simulate and export aerial surveys of buildings
.SH SYNOPSIS
.B skycap
.I COMMAND
[\\fIOPTIONS\\fR]
.SH DESCRIPTION
${overview}")
foreach(command IN LISTS commands)
  string(STRIP "${command}" command)
  ask(text ${command})
  string(APPEND page ".SH \"SKYCAP ${command}\"\n${text}")
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
Done. skycap next: a view is proposed.
.TP
.B 1
Negative result (the mission cannot work, the route violates the clearance), incomplete, or
interrupted by a signal.
.TP
.B 2
Bad input: command line, mission file, other file, or a full disk.
.TP
.B 3
Internal failure, lack of memory, or standard output cannot be written.
.TP
.B 10
skycap next: the survey is over.
.TP
.B 11
skycap next: every useful view is rejected or unreachable.
.TP
.B 12
skycap next: the last scan is rejected.
.TP
.B 143
A task of campaign, district, scan or evaluate ended by SIGTERM.
.SH FILES
.TP
.I /usr/share/skycap/missions
example missions
.SH SEE ALSO
bash, zsh and fish complete commands and options: skycap completion SHELL prints their scripts.
")
string(REGEX REPLACE "\\.gz$" "" plain ${PAGE})
file(WRITE ${plain} "${page}")
execute_process(COMMAND gzip -9nf ${plain} COMMAND_ERROR_IS_FATAL ANY)
