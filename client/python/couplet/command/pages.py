# SPDX-License-Identifier: Apache-2.0
"""Man pages and completion, made from what the command and the programs declare.
Usage: python3 -m couplet.command.pages SHARE [--bin BIN] [--version V]: writes SHARE/man, SHARE/bash-completion, SHARE/zsh"""
import argparse
import pathlib
import re
import subprocess

from couplet import command
from couplet.runs.case import OURS


def plain(text):
    """Text as groff takes it."""
    text = text.replace("\\", "\\e").replace("-", "\\-")
    return "\n".join("\\&" + line if line.startswith((".", "'")) else line for line in text.splitlines())


def page(name, summary, sections, version):
    text = f'.\\" SPDX-License-Identifier: Apache-2.0\n.TH {name.upper()} 1 "" "Couplet {version}" "Couplet"\n.SH NAME\n{plain(name)} \\- {plain(summary)}\n'
    return text + "".join(f".SH {head}\n{body}\n" for head, body in sections if body)


def options_of(parser):
    """[(names, value, help)] of a parser's options, then of its places."""
    for action in parser._actions:
        value = action.metavar or (action.dest.upper() if action.nargs != 0 else "")
        yield action.option_strings, "" if action.nargs == 0 else str(value), (action.help or "").replace("%%", "%")


def of_subcommand(name, version):
    parser = command.parser_of(name)
    usage = re.sub(r"\s+", " ", parser.format_usage().removeprefix("usage: "))
    items = [f".TP\n\\fB{plain(', '.join(names) or value)}\\fR {plain(value if names else '')}\n{plain(about)}" for names, value, about in options_of(parser)]
    return page(f"couplet-{name}", command.SUBCOMMANDS[name][1], [("SYNOPSIS", plain(usage)), ("DESCRIPTION", plain(parser.description or "")),
                ("OPTIONS", "\n".join(items)), ("SEE ALSO", "couplet(1)")], version)


def of_command(version):
    items = [f".TP\n\\fBcouplet\\-{name}\\fR(1)\n{plain(text)}" for name, (_, text) in command.SUBCOMMANDS.items()]
    codes = command.GUIDE.partition("Exit codes")[2]
    places = ".TP\n\\fBCOUPLET_BIN\\fR\nfolder bin/ of the programs, where another than the one beside the command is meant"
    return page("couplet", "couples physics programs into one MPI job", [("SYNOPSIS", "couplet COMMAND ..."), ("COMMANDS", "\n".join(items)),
                ("EXIT STATUS", plain("Exit codes" + codes)), ("ENVIRONMENT", places), ("SEE ALSO", ", ".join(f"{p}(1)" for p in sorted(OURS)))], version)


def of_program(bin_, name, version):
    """From --help: what it is, its options, its keys."""
    said = subprocess.run([bin_ / name, "--help"], capture_output=True, text=True, check=True).stdout
    first, _, rest = said.partition("\n")
    parts = re.split(r"^(Options|Keys[^\n]*|Alone|Exit codes):", rest, flags=re.M)
    sections = [("SYNOPSIS", plain(re.search(r"Usage: (.*)", rest)[1]))]
    for head, body in zip(parts[1::2], parts[2::2]):
        sections.append((head.upper().replace("ALONE", "LAUNCHING"), ".nf\n" + plain(("Alone:" if head == "Alone" else "") + body.strip("\n")) + "\n.fi"))
    return page(name, first, [*sections, ("SEE ALSO", "couplet(1)")], version)


def bash():
    options = {name: " ".join(n for names, _, _ in options_of(command.parser_of(name)) for n in names) for name in command.SUBCOMMANDS}
    cases = "\n".join(f"    {name}) words='{words}' ;;" for name, words in options.items())
    return f"""# SPDX-License-Identifier: Apache-2.0
# Completion of couplet for bash, made from what the command declares.
_couplet() {{
  local now=${{COMP_WORDS[COMP_CWORD]}} words=
  COMPREPLY=()
  if (( COMP_CWORD == 1 )); then
    COMPREPLY=($(compgen -W '{' '.join(command.SUBCOMMANDS)}' -- "$now"))
    return
  fi
  case ${{COMP_WORDS[1]}} in
{cases}
  esac
  if [[ ${{COMP_WORDS[1]}} == new && ${{COMP_WORDS[COMP_CWORD - 1]}} == --from ]]; then
    COMPREPLY=($(compgen -W "$(couplet gallery | cut -d' ' -f1)" -- "$now"))
  elif [[ $now == -* ]]; then
    COMPREPLY=($(compgen -W "$words" -- "$now"))
  fi
}}
complete -o default -F _couplet couplet
"""


def zsh():
    commands = " ".join(f"'{name}:{text}'" for name, (_, text) in command.SUBCOMMANDS.items()).replace("'s ", "'\\''s ")
    quoted = lambda text: text.replace("'", "'\\''").replace("[", "(").replace("]", ")").replace(":", "\\:")
    cases = ""
    for name in command.SUBCOMMANDS:
        options = [f"'{n}[{quoted(about)}]{':' + quoted(value) + ':_files' if value else ''}'" for names, value, about in options_of(command.parser_of(name)) for n in names]
        cases += f"    {name}) _arguments {' '.join(options)} '*:file:_files' ;;\n"
    return f"""#compdef couplet
# SPDX-License-Identifier: Apache-2.0
# Completion of couplet for zsh, made from what the command declares.
_couplet() {{
  local -a commands=({commands})
  if (( CURRENT == 2 )); then
    _describe command commands
    return
  fi
  local name=$words[2]
  shift words
  (( CURRENT-- ))
  case $name in
{cases}  esac
}}
_couplet "$@"
"""


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("share", type=pathlib.Path)
    parser.add_argument("--bin", type=pathlib.Path)
    parser.add_argument("--version", default=None)
    arguments = parser.parse_args()
    version = arguments.version or command.version()
    zsh_folder = "vendor-completions" if arguments.share.parts[-2:] == ("usr", "share") else "site-functions"  # as Debian has it
    files = {"man/man1/couplet.1": of_command(version), "bash-completion/completions/couplet": bash(), f"zsh/{zsh_folder}/_couplet": zsh()}
    files |= {f"man/man1/couplet-{name}.1": of_subcommand(name, version) for name in command.SUBCOMMANDS}
    files |= {f"man/man1/{name}.1": of_program(arguments.bin, name, version) for name in OURS if arguments.bin and (arguments.bin / name).exists()}
    for name, text in files.items():
        file = arguments.share / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text)


if __name__ == "__main__":
    main()
