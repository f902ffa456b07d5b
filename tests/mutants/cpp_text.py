# SPDX-License-Identifier: Apache-2.0
"""What of a C++ source is code that computes: without comments, strings and declarations, statement by statement."""
import bisect
import dataclasses
import re

_SKIPPED = re.compile(r'//[^\n]*|/\*.*?\*/|R"\((?:.*?)\)"|"(?:\\.|[^"\\\n])*"|(?<![\w])\'(?:\\.|[^\'\\\n])+\'|^[ \t]*#[^\n]*',
                      re.S | re.M)
# A brace behind these opens no body of a function.
_SCOPE = re.compile(r"(?:^|[;{}\s])(?:namespace|class|struct|union|enum|extern)\b[^;{}()]*$")
# A statement that only speaks, or that only says what things are.
_SPEAKS = re.compile(r"\b(?:fmt::|throw|log_?\w*\(|warn\w*|note\(|Error\(|SolveFailure|assert|static_assert|template|using|typedef|friend|"
                     r"doc\(|string|std::string|save\(|load\(|\w*write\w*\()")
# What counts and finds places, where a broken number is out of bounds at once.
_COUNTS = re.compile(r"^\s*(?:const\s+)?(?:Index|std::size_t|int|auto|GlobalIndex|std::ptrdiff_t|Eigen::Index)\b|"
                     r"\.(?:resize|reserve|assign|insert|erase|data|begin)\(|double\*|statistics|iterations|isfinite|std::size_t\(|\bIndex\(")
CONSTANT = re.compile(r"^\s*(?:const|constexpr|static constexpr|inline constexpr) (?:double|float|int)\b")


@dataclasses.dataclass(frozen=True)
class Statement:
    begin: int  # in the text
    text: str  # of the masked source, so that places agree
    raw: str  # of the source
    function: int  # number of the function's body in its file; 0 for a constant outside of all

    @property
    def counts(self):
        """Whether it finds places or counts what was done, and computes nothing of the physics."""
        return bool(_COUNTS.search(re.sub(r"\[[^\[\]]*\]", "[]", self.text)))


def masked(source):
    """The source with blanks for what is no code; lines and places stay."""
    return _SKIPPED.sub(lambda m: re.sub(r"[^\n]", " ", m[0]), source)


def line_of(source, place):
    return source.count("\n", 0, place) + 1


def _bodies(code):
    """(begin, end) of the bodies of functions: the outermost braces that are neither of a scope nor of an initialiser there."""
    found, depth, begin, scopes, last = [], 0, None, 0, 0
    for m in re.finditer(r"[{};]", code):
        if m[0] == "{":
            if begin is None:
                head = code[last:m.start()]
                if _SCOPE.search(head):
                    scopes += 1
                elif re.search(r"\)\s*(?:const|noexcept|override|final|\s)*(?::[^;]*|->[^;]*)?$", head):
                    begin, depth = m.start() + 1, 1
                else:
                    begin, depth = -1, 1  # an initialiser outside of functions
            else:
                depth += 1
        elif m[0] == "}":
            if begin is None:
                scopes -= 1
            else:
                depth -= 1
                if depth == 0:
                    if begin > 0:
                        found.append((begin, m.start()))
                    begin = None
        last = m.end()
    return found


def statements(source):
    """The statements that compute, in their order."""
    code = masked(source)
    bodies = _bodies(code)
    begins = [b for b, _ in bodies]
    result, start, depth = [], 0, 0
    for k, c in enumerate(code):
        depth += {"(": 1, ")": -1}.get(c, 0)
        if c not in ";{}" or (depth > 0 and c != ";") or (depth > 0 and "for" in code[start:k]):
            if not (c in "{}" and "{" in code[start:k + 1]):
                continue
            if depth > 0 and "[" not in code[start:k]:  # an initialiser within a call
                continue
        if c == "}" and depth > 0:
            depth = max(depth, 0)
        text = code[start:k + 1]
        where = bisect.bisect_right(begins, start + len(text) - len(text.lstrip()))
        inside = where > 0 and start < bodies[where - 1][1]
        if text.strip(" \n;{}") and (inside or CONSTANT.search(text)) and not _SPEAKS.search(text):
            result.append(Statement(start, text, source[start:k + 1], where if inside else 0))
        start = k + 1
    return result
