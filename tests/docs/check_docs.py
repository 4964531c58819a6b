# SPDX-License-Identifier: Apache-2.0
"""Checks that the documentation is true.

    check_docs.py PROGRAM ROOT

PROGRAM is the built `physpring`, ROOT the source folder. Prints a line for each thing that is wrong
and exits with status 1; prints nothing and exits with 0 if all is right:
    links      relative links in *.md lead to a file that is there
    pages      every page in docs/ is linked from README.md or from another page
    cells      no table cell of README.md, CONTRIBUTING.md and docs/ is over 30 words
    decisions  docs/decisions/NNN-*.md have Status, Decision, Against and Measured, at most 150
               words, a number of their own, and are in the index
    tables     that of docs/physics.md has the effects of twin/effects/list.h, that of
               docs/hierarchy.md the reductions of trainer/reduction/registry.cc, no others
    commands   in code blocks of README.md and docs/, commands and flags of lines that begin with
               `physpring ` are in the program's help
"""

import pathlib
import re
import subprocess
import sys

MOST_WORDS_IN_CELL = 30
MOST_WORDS_IN_DECISION = 150
DECISION_PARTS = ("Status", "Decision", "Against", "Measured")

# Where pages of ours are, besides the root itself.
FOLDERS = ("bench", "cli", "diagnosis", "docs", "exporter", "jobs", "models", "pictures", "plugin", "python",
           "registration", "report", "tracker",
           "rollout", "scripts", "splats", "tests", "third_party", "tools", "trainer", "twin")

FENCE = re.compile(r"^\s*(```|~~~)")
LINK = re.compile(r"!?\[[^\]]*\]\(\s*<?([^)\s>]+)>?[^)]*\)")
FLAG = re.compile(r"(?<![\w-])--?[A-Za-z][\w-]*")


def lines_with_code(text):
    """(line number, line, whether it is in a code block) of each line but the fences."""
    fenced, indented, last_blank = False, False, True
    for number, line in enumerate(text.splitlines(), 1):
        if FENCE.match(line):
            fenced = not fenced
            continue
        indented = not fenced and line.startswith("    ") and (indented or last_blank)
        yield number, line, fenced or indented
        last_blank = not line.strip()


def pages_of(root):
    """All pages of ours: their paths, relative to the root."""
    pages = list(root.glob("*.md"))
    for folder in FOLDERS:
        pages += (root / folder).rglob("*.md")
    return sorted(page.relative_to(root) for page in pages)


def links_of(text):
    """(line number, target) of each link that is not in code."""
    for number, line, in_code in lines_with_code(text):
        if in_code:
            continue
        for target in LINK.findall(re.sub(r"`[^`]*`", "", line)):
            yield number, target


def check_links(root, texts):
    """What is wrong with links, and the pages that are linked from another one."""
    wrong, linked = [], set()
    for page, text in texts.items():
        for number, target in links_of(text):
            if re.match(r"[a-z][a-z0-9+.-]*:", target) or target.startswith("#"):
                continue
            path = (root / page.parent / target.split("#")[0]).resolve()
            if not path.exists():
                wrong.append(f"{page}:{number}: the link to {target} leads nowhere")
            elif path.is_relative_to(root) and path.relative_to(root) != page:
                linked.add(path.relative_to(root))
    return wrong, linked


def check_pages_are_linked(texts, linked):
    return [f"{page}: no other page links to it; add it to the table in README.md"
            for page in texts if page.parts[0] == "docs" and page not in linked]


def cells_of(line):
    return re.split(r"(?<!\\)\|", line.strip().strip("|"))


def check_cells(texts):
    wrong = []
    for page, text in texts.items():
        name = page.as_posix()
        if page.parts[0] != "docs" and name not in ("README.md", "CONTRIBUTING.md"):
            continue
        for number, line, in_code in lines_with_code(text):
            if in_code or not line.lstrip().startswith("|"):
                continue
            for words in (len(cell.split()) for cell in cells_of(line)):
                if words > MOST_WORDS_IN_CELL:
                    wrong.append(f"{page}:{number}: a table cell of {words} words, at most "
                                 f"{MOST_WORDS_IN_CELL}")
    return wrong


def check_status(page, text, records):
    """A record's status is one of those allowed, and names a record that is there."""
    status = re.search(r"^\*\*Status\.\*\* (.*)$", text, re.MULTILINE)
    other = status and re.fullmatch(r"overruled by \[(\d{3})\]\(.*\)", status.group(1))
    if not status or not (other or status.group(1) in ("accepted", "superseded")):
        return [f"{page}: its status is none of: accepted, superseded, overruled by [NNN](file)"]
    if other and other.group(1) not in records:
        return [f"{page}: overruled by {other.group(1)}, which is not there"]
    return []


def check_decisions(texts):
    wrong = []
    folder = pathlib.Path("docs/decisions")
    pages = [page for page in texts if page.parent == folder and re.match(r"\d{3}-", page.name)]
    records = [page.name[:3] for page in pages]
    index = texts.get(folder / "README.md", "")
    for page in pages:
        text = texts[page]
        for part in DECISION_PARTS:
            if not re.search(rf"^\*\*{part}\.\*\* \S", text, re.MULTILINE):
                wrong.append(f"{page}: says nothing of {part}")
        wrong += check_status(page, text, records)
        words = len(text.split())
        if words > MOST_WORDS_IN_DECISION:
            wrong.append(f"{page}: {words} words, at most {MOST_WORDS_IN_DECISION}")
        if f"({page.name})" not in index:
            wrong.append(f"{page}: is not in the index {folder / 'README.md'}")
        if records.count(page.name[:3]) > 1:
            wrong.append(f"{page}: another record has its number")
    return wrong


def check_table(root, texts, registry, page, kind, entry, heading):
    """The table of a page has a row for each entry of a registry, and no others."""
    text = (root / registry).read_text(encoding="utf-8")
    known = {name.lower() for name in re.findall(rf"^ +{entry}\((\w+)\)", text, re.MULTILINE)}
    table = re.search(rf"^\| {heading} \|.*\n((?:\|.*\n)*)", texts[pathlib.Path(page)],
                      re.MULTILINE)
    rows = re.findall(r"^\| `(\w+)`", table.group(1) if table else "", re.MULTILINE)
    told = {name.replace("_", "") for name in rows}
    return ([f"{page}: the table lacks the {kind} {name}" for name in sorted(known - told)] +
            [f"{page}: there is no {kind} {name}" for name in sorted(told - known)])


def commands_of(text):
    """(line number, words) of each command in code, lines that go on joined, without comments."""
    number_of_first, joined = 0, ""
    for number, line, in_code in lines_with_code(text):
        line = line.strip()
        if not joined and not (in_code and line.startswith("physpring ")):
            continue
        number_of_first = number_of_first or number
        joined += line.removesuffix("\\") + " "
        if line.endswith("\\"):
            continue
        yield number_of_first, re.split(r"\s#|[|;]|&&", joined)[0].split()
        number_of_first, joined = 0, ""


class Help:
    """What the program's help knows."""

    def __init__(self, program):
        self._program = program
        self._flags = {}

    def flags(self, command):
        """The flags of a command; nothing if there is no such command."""
        if command not in self._flags:
            # "COMMAND --help" of a command that is none fails, or is the help of the program itself
            run = subprocess.run([self._program, command, "--help"], capture_output=True, text=True,
                                 check=False)
            known = run.returncode == 0 and re.search(rf"^Usage: .*\b{re.escape(command)}\b",
                                                      run.stdout, re.MULTILINE)
            self._flags[command] = self._flags_in(run.stdout) if known else None
        return self._flags[command]

    @staticmethod
    def _flags_in(text):
        flags = set()
        for line in text.splitlines():
            head = re.match(r"\s+(-[^\s]*)", line)  # "  -o,--output FILE  what it is"
            if head:
                flags.update(FLAG.findall(head.group(1).replace(",", " ")))
        return flags


def check_commands(texts, program_help):
    wrong = []
    for page, text in texts.items():
        if page.parts[0] != "docs" and str(page) != "README.md":
            continue
        for number, words in commands_of(text):
            command = words[1] if len(words) > 1 else ""
            if command.startswith("-") or command.isupper():
                continue  # `physpring --help`, `physpring COMMAND --help`
            known = program_help.flags(command)
            if known is None:
                wrong.append(f"{page}:{number}: there is no `physpring {command}`")
                continue
            for word in words[2:]:
                flag = FLAG.match(word)
                if flag and flag.group(0) not in known:
                    wrong.append(f"{page}:{number}: `physpring {command}` has no {flag.group(0)}")
    return wrong


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    root = pathlib.Path(sys.argv[2]).resolve()
    texts = {page: (root / page).read_text(encoding="utf-8") for page in pages_of(root)}
    wrong, linked = check_links(root, texts)
    wrong += check_pages_are_linked(texts, linked)
    wrong += check_cells(texts)
    wrong += check_decisions(texts)
    wrong += check_table(root, texts, "twin/effects/list.h", "docs/physics.md", "effect",
                         "(?:TWIN|BOTH)", "effect")
    wrong += check_table(root, texts, "trainer/reduction/registry.cc", "docs/hierarchy.md",
                         "reduction", "REDUCTION", "`--reduction`")
    wrong += check_commands(texts, Help(sys.argv[1]))
    for line in wrong:
        print(line)
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    main()
