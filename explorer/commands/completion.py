"""`nearflat completion`: what bash and zsh need to complete commands, scenes and options."""

import argparse

from explorer.commands import Answer
from explorer.scenes.scene import NAMES

# Of these the options depend on the scene.
_OF_SCENES = ("run", "plan")
_SCRIPT = """_nearflat() {{
  local words
  case "${{COMP_WORDS[*]:1:COMP_CWORD-1}} " in
{cases}
    *) words="{commands}" ;;
  esac
  COMPREPLY=($(compgen -W "$words" -- "${{COMP_WORDS[COMP_CWORD]}}"))
}}
complete -o default -F _nearflat nearflat"""


def call(options: argparse.Namespace) -> Answer:
    """The script."""
    from explorer.commands.main import COMMANDS, parser_of

    asked = [(name, scene) for name in _OF_SCENES for scene in NAMES] + [(name, "") for name in COMMANDS]
    found = {}
    for name, scene in asked:
        flags = [flag for action in parser_of(name, [scene])._actions for flag in action.option_strings]
        own = [flag for flag in flags if flag.startswith("--")]
        found[" ".join([name, scene]).strip()] = NAMES if name in _OF_SCENES and not scene else own
    cases = [f'    "{line} "*) words="{" ".join(words)}" ;;' for line, words in found.items()]
    return Answer(found, _SCRIPT.format(cases="\n".join(cases), commands=" ".join(COMMANDS)))
