"""Completions for bash, zsh and fish, written from the command line itself."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence

from hysdel_py.cli.command_tree import Command, Option

__all__ = ["SHELLS", "bash_script", "fish_script", "zsh_script"]

Script = Callable[[Command, Sequence[Command], Sequence[str]], str]

_BASH_HEAD = """\
# bash completion of hysdel: source it, or put it into a folder of completions
_hysdel() {
    local current="${COMP_WORDS[COMP_CWORD]}" previous="${COMP_WORDS[COMP_CWORD-1]}" command="" word
    for word in "${COMP_WORDS[@]:1:COMP_CWORD-1}"; do
        [[ $word != -* ]] && command=$word && break
    done
    COMPREPLY=()
"""
_BASH_TAIL = """\
}
complete -o filenames -o bashdefault -F _hysdel hysdel
"""

_ZSH_HEAD = """\
#compdef hysdel
_hysdel() {{
    local -a commands
    commands=(
{commands}
    )
    if (( CURRENT == 2 )); then
        if [[ $PREFIX == -* ]]; then
            compadd -- {flags}
        else
            _describe command commands
        fi
        return
    fi
    local command=$words[2]
    shift words
    (( CURRENT-- ))
    case $command in
"""
_ZSH_TAIL = """
    esac
}
if [ "$funcstack[1]" = "_hysdel" ]; then
    _hysdel "$@"
else
    compdef _hysdel hysdel
fi
"""


def bash_script(root: Command, commands: Sequence[Command], models: Sequence[str]) -> str:
    """The script for bash; `models` are shipped ones, offered beside files."""
    first = _words([*(command.name for command in commands), *root.flags])
    cases = [*_bash_case('""', [first])]
    for command in commands:
        cases += _bash_case(command.name, _bash_command(command, models))
    return "\n".join([_BASH_HEAD.rstrip(), '    case "$command" in', *cases, "    esac", _BASH_TAIL])


def _bash_case(pattern: str, lines: Iterable[str]) -> Iterator[str]:
    yield f"        {pattern})"
    yield from (f"            {line}" for line in lines)
    yield "            ;;"


def _bash_command(command: Command, models: Sequence[str]) -> Iterator[str]:
    yield 'case "$previous" in'
    for option in command.options:
        if option.flags and option.metavar:
            yield f"    {'|'.join(option.flags)}) {_bash_value(option)}; return ;;"
    yield "esac"
    yield "if [[ $current == -* ]]; then"
    yield f"    {_words(command.flags)}"
    yield "else"
    yield f"    {_bash_positional(command, models)}"
    yield "fi"


def _bash_value(option: Option) -> str:
    if option.choices:
        return _words(option.choices)
    if option.takes_folder:
        return 'COMPREPLY=($(compgen -d -- "$current"))'
    return 'COMPREPLY=($(compgen -f -- "$current"))' if option.takes_file else "COMPREPLY=()"


def _bash_positional(command: Command, models: Sequence[str]) -> str:
    choices = [choice for option in command.positional for choice in option.choices]
    if choices:
        return _words(choices)
    if not command.positional:
        return "COMPREPLY=()"
    return f'COMPREPLY=($(compgen -W "{" ".join(models)}" -- "$current") $(compgen -f -- "$current"))'


def _words(words: Sequence[str]) -> str:
    return f'COMPREPLY=($(compgen -W "{" ".join(words)}" -- "$current"))'


def zsh_script(root: Command, commands: Sequence[Command], models: Sequence[str]) -> str:
    """The script for zsh, as a function of a folder in fpath."""
    named = [f"        {_quoted(f'{c.name}:{_one_line(c.help)}')}" for c in commands]
    words = _ZSH_HEAD.format(commands="\n".join(named), flags=" ".join(map(_quoted, root.flags)))
    cases = [line for command in commands for line in _zsh_case(command, models)]
    return words + "\n".join(cases) + _ZSH_TAIL


def _zsh_case(command: Command, models: Sequence[str]) -> Iterator[str]:
    yield f"        {command.name})"
    yield "            _arguments \\"
    yield from (f"                {_zsh_spec(option, models)} \\" for option in command.options)
    yield "                && return"
    yield "            ;;"


def _zsh_spec(option: Option, models: Sequence[str]) -> str:
    told = _one_line(option.help).replace("\\", "\\\\").replace("[", "\\[").replace("]", "\\]").replace(":", "\\:")
    value = _zsh_value(option, models)
    if not option.flags:
        return _quoted(f"*:{_zsh_word(option.metavar)}:{value}")
    tail = f":{_zsh_word(option.metavar)}:{value}" if option.metavar else ""
    return " ".join(_quoted(f"*{flag}[{told}]{tail}") for flag in option.flags)


def _zsh_value(option: Option, models: Sequence[str]) -> str:
    if option.choices:
        return f"({' '.join(option.choices)})"
    if option.takes_folder:
        return "_files -/"
    if not option.flags and option.metavar == "FILE":
        return f'{{_alternative "models:model:({" ".join(models)})" "files:file:_files"}}'
    return "_files" if option.takes_file else " "


def _zsh_word(metavar: str) -> str:
    return metavar.replace(":", " ").replace("[", "").replace("]", "") or "value"


def fish_script(root: Command, commands: Sequence[Command], models: Sequence[str]) -> str:
    """The script for fish."""
    lines = ["# fish completion of hysdel", "complete -c hysdel -e", "complete -c hysdel -f -n __fish_use_subcommand"]
    lines += [_fish_option(option, "__fish_use_subcommand") for option in root.options if option.flags]
    for command in commands:
        lines.append(
            f"complete -c hysdel -f -n __fish_use_subcommand -a {command.name} -d {_quoted(_one_line(command.help))}"
        )
        condition = f"__fish_seen_subcommand_from {command.name}"
        lines += [_fish_option(option, condition) for option in command.options if option.flags]
        lines += [line for option in command.positional for line in _fish_positional(option, condition, models)]
    return "\n".join([*lines, ""])


def _fish_option(option: Option, condition: str) -> str:
    names = " ".join(f"-l {flag[2:]}" if flag.startswith("--") else f"-s {flag[1:]}" for flag in option.flags)
    value = f" -x -a {_quoted(' '.join(option.choices))}" if option.choices else ""
    if option.metavar and not option.choices:
        value = " -r -F" if option.takes_file or option.takes_folder else " -x"
    return f"complete -c hysdel -n {_quoted(condition)} {names}{value} -d {_quoted(_one_line(option.help))}"


def _fish_positional(option: Option, condition: str, models: Sequence[str]) -> Iterator[str]:
    words = option.choices or (models if option.metavar == "FILE" else ())
    files = "-f" if option.choices else "-F"
    offered = f" -a {_quoted(' '.join(words))}" if words else ""
    yield f"complete -c hysdel -n {_quoted(condition)} {files}{offered}"


def _one_line(text: str) -> str:
    return " ".join(text.split())


def _quoted(text: str) -> str:
    """A word in single quotes, which all three shells leave alone."""
    return "'" + text.replace("'", "’") + "'"


SHELLS: dict[str, Script] = {"bash": bash_script, "zsh": zsh_script, "fish": fish_script}
"""The writer for each shell."""
