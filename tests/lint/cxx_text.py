# SPDX-License-Identifier: Apache-2.0
"""C++ and protobuf sources cut into code, comments and literals; and the types that they define."""
import re

LITERAL = re.compile(
    r'(?P<comment>//[^\n]*|/\*.*?\*/)'
    r'|(?P<string>R"(?P<mark>[^()\\ \n]{0,16})\(.*?\)(?P=mark)"|"(?:\\.|[^"\\\n])*"'
    r"|(?<![0-9A-Fa-f])'(?:\\[^'\n]+|[^'\\\n])')",
    re.DOTALL)


def pieces(text):
    """Yields (kind, offset, text) in order; kind is "code", "comment" or "string"."""
    at = 0
    for match in LITERAL.finditer(text):
        if match.start() > at:
            yield "code", at, text[at:match.start()]
        yield ("comment" if match["comment"] else "string"), match.start(), match[0]
        at = match.end()
    if at < len(text):
        yield "code", at, text[at:]


def code_only(text):
    """`text` with comments and literals blanked out; lines and columns stay."""
    def blank(piece):
        return re.sub(r"[^\n]", " ", piece)
    return "".join(piece if kind == "code" else blank(piece) for kind, _, piece in pieces(text))


def comment_blocks(text):
    """Yields (line number, lines) of each comment: lines that follow each other in one column belong together."""
    block, first, last_line, column = [], 0, -1, -1
    for kind, offset, piece in pieces(text):
        if kind != "comment" or piece.startswith("/*"):
            continue
        line = text.count("\n", 0, offset) + 1
        here = offset - (text.rfind("\n", 0, offset) + 1)
        is_alone = not text[offset - here:offset].strip()
        if not (block and is_alone and line == last_line + 1 and here == column):
            if block:
                yield first, block
            block, first, column = [], line, here
        block.append(re.sub(r"^//[/!]?<?", "", piece))
        last_line = line
    if block:
        yield first, block


DIAGRAM = re.compile(r"[─-╿▲▼◀▶◄►●·]|-->|\.\.\.\.")


def paragraphs(text):
    """Yields (line number, text) of each comment's paragraphs, without diagrams, examples and bullets."""
    for first, lines in comment_blocks(text):
        start, words = first, []
        for number, line in enumerate(lines + [""], first):
            is_bullet = re.match(r"\s*[-*\d]+[.)]? ", line)
            is_prose = line.strip() and not line.startswith("   ") and not DIAGRAM.search(line) and not is_bullet
            if is_prose:
                if not words:
                    start = number
                words.append(line.strip())
            elif words:
                yield start, " ".join(words)
                words = []


TOKEN = re.compile(r"[A-Za-z_]\w*|::|[{}();<>:=,\[\]]|\S")
DIRECTIVE = re.compile(r"^[ \t]*#(?:[^\n\\]|\\.|\\\n)*", re.MULTILINE)
TYPE_WORDS = {"class", "struct", "union", "enum"}


def _head_of(tokens):
    """(kind, name) of what the tokens before a brace open: ("namespace", "a::b"), ("type", "Name") or ("other", "")."""
    if "namespace" in tokens:
        at = tokens.index("namespace")
        return "namespace", "".join(t for t in tokens[at + 1:] if t != "inline")
    depth, plain = 0, []
    for token in tokens:  # Without template arguments and attributes, which name types as well.
        if token in "<[(":
            depth += 1
        elif token in ">])":
            depth = max(0, depth - 1)
            if token == ")":
                plain.append(")")
        elif depth == 0:
            plain.append(token)
    for at, token in enumerate(plain):
        if token in TYPE_WORDS and ")" not in plain[at:] and "=" not in plain[:at]:
            name, k = "", at + 1
            if k < len(plain) and plain[k] in ("class", "struct"):
                k += 1
            while k < len(plain) and plain[k] != "final" and re.match(r"::|[A-Za-z_]\w*$", plain[k]):
                name = name + plain[k] if plain[k] == "::" or name.endswith("::") else plain[k]
                k += 1
            after = tokens[len(tokens) - 1 - tokens[::-1].index(token):]
            is_special = "template" in tokens and "<" in after[:after.index(":") if ":" in after else len(after)]
            return ("other", "") if is_special else ("type", name)
    return "other", ""


def types_of(text):
    """Yields (line number, full name) of each type that is defined outside functions and unnamed namespaces."""
    code = DIRECTIVE.sub(lambda m: re.sub(r"[^\n]", " ", m[0]), code_only(text))
    scopes, head = [], []
    for match in TOKEN.finditer(code):
        token = match[0]
        if token == "{":
            kind, name = _head_of(head)
            if kind == "namespace" and not name:
                kind = "other"
            if kind == "type" and name and all(k != "other" for k, _ in scopes):
                yield code.count("\n", 0, match.start()) + 1, "::".join([n for _, n in scopes] + [name])
            scopes.append((kind, name))
            head = []
        elif token == "}":
            if scopes:
                scopes.pop()
            head = []
        elif token == ";" or (token == ":" and head[-1:] in (["public"], ["private"], ["protected"])):
            head = []
        else:
            head.append(token)
