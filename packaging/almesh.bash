# Completion of almesh for bash: commands and keys of decks, and where none of them fits, files.
_almesh() {
    local words word=${COMP_WORDS[COMP_CWORD]}
    if [ "$word" = "=" ] || [ "${COMP_WORDS[COMP_CWORD - 1]}" = "=" ]; then return; fi
    if [ "$COMP_CWORD" -eq 1 ]; then
        words="info quality improve adjoint tangent sweep --keys --version --help"
    else
        words=$("${COMP_WORDS[0]}" --keys 2>/dev/null | sed -n -e '/^$/q' -e '2,$s/^\([a-z]\w*\) .*/\1=/p')
        compopt -o nospace 2>/dev/null
    fi
    [ -z "$word" ] || COMPREPLY=($(compgen -W "$words" -- "$word"))
    [ ${#COMPREPLY[@]} -gt 0 ] || compopt +o nospace 2>/dev/null
}
complete -o default -F _almesh almesh
