# Completion for bash. Commands and options are read from the help of the program.
_skycap() {
  local current=${COMP_WORDS[COMP_CWORD]} verb= word
  for word in "${COMP_WORDS[@]:1:COMP_CWORD-1}"; do
    [[ $word == -* ]] || { verb=$word; break; }
  done
  if [[ $current == -* ]]; then
    word=$("${COMP_WORDS[0]}" ${verb:+"$verb"} --help 2>/dev/null | grep -oE -- '--[a-z][a-z-]*')
    mapfile -t COMPREPLY < <(compgen -W "$word" -- "$current")
  elif [[ -z $verb ]]; then
    word=$("${COMP_WORDS[0]}" --help 2>/dev/null | sed -n '/^Subcommands/,$s/^  \([a-z-]*\) .*/\1/p')
    mapfile -t COMPREPLY < <(compgen -W "$word" -- "$current")
  else
    mapfile -t COMPREPLY < <(compgen -f -- "$current")
    compopt -o filenames
  fi
}
complete -F _skycap skycap
