# SPDX-License-Identifier: Apache-2.0
"""How long a file and a function and how large a class may be, and what is longer for a written reason."""
import re

HOUSE = ("common", "solid_solver", "fluid_solver", "mesh_mover", "thermocline", "plate_modal", "coupler")
LONGEST, LONGEST_ELSEWHERE = 300, 500  # lines of a file of the programs and of common; of tests, scripts and cases
LONGEST_FUNCTION = 60
MOST_MEMBERS, MOST_FOR_A_REASON = 25, 40  # functions of one class

BRACE = re.compile("[{}]")

LONG_FILES = {}
PARTICIPANT = "a participant answers {} calls of the coupling, each with its part of the state"
LARGE_CLASSES = {
    "FluidParticipant": PARTICIPANT.format("fourteen"),
    "Structure": PARTICIPANT.format("twelve"),
    "TankModel": "gives to and takes from each element of a tank, one function for each pair",
    "ThermalStrain": "overrides the calls of SolidEffect, of which it needs all",
    "SolidBody": "hands out what the parts of a body are; most functions return a member",
    "Coupler": "the pass, its judges and the calls of a step share one state",
    "SolidStepper": "the stages of a step, each a function, share one state",
    "Fluid": "hands out what the parts of a fluid are; most functions return a member",
    "FractionalStep": "the sub-steps of a step, each a function, share one state",
    "PressureProjection": "rows of the pressure for each kind of wall and gap",
    "PackedBed": "fluid, filler and capsules are eliminated cell by cell, together",
    "ElasticOperator": "hands out constants, conditions and unknowns of the rows",
    "SymmetricSpace": "trial functions: values, forces, loads, mass and springs act on the same arrays",
    "FiniteKernelOf": "implements FiniteKernel, whose calls are those of Newton's method",
    "FiniteStrain": "implements LargeStrain; the iteration's parts share its vectors",
    "Equilibrium": "what a body is asked at small and at large strain, by its motion, its fields and its judge",
    "ConductionOperator": "hands out unknowns, known values and conditions of the faces",
}


def without_nested(text):
    """`text` with each outermost {...} as {} and without <...>, comments and literals gone already."""
    flat, depth = [], 0
    for part in re.findall(r"[{}]|[^{}]+", text):
        depth -= part == "}"
        if depth == 0:
            flat.append(part)
        depth += part == "{"
    flat = "".join(flat).replace("<<", "").replace(">>=", "").replace("operator<", "operator").replace("->", "")
    while True:
        fewer = re.sub(r"<[^<>;{}]*>", "", flat)
        if fewer == flat:
            return flat
        flat = fewer


def members_of_classes(text):
    """(name, line, member functions declared in the body) of each class and struct, nested ones apart."""
    blank = lambda match: re.sub(r"[^\n]", " ", match.group())
    text = re.sub(r'//[^\n]*|/\*.*?\*/|R"(\w*)\(.*?\)\1"|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])\'(?!\w)', blank, text, flags=re.S)
    found = []
    for match in re.finditer(r"\b(?:class|struct)\s+(?:\[\[\w+\]\]\s*)?([\w:]+)(?:\s+final)?\s*(?::[^:;{(][^;{(]*)?\{", text):
        if re.search(r"\benum\s+$", text[:match.start()]):
            continue
        end, depth = len(text), 1
        for brace in BRACE.finditer(text, match.end()):
            depth += 1 if brace.group() == "{" else -1
            if not depth:
                end = brace.end()
                break
        body = re.sub(r"\b(?:public|protected|private)\s*:", "", without_nested(text[match.end():end - 1]))
        functions = 0
        for statement in re.split(r";|\{\}", body):
            head = re.split(r"(?<!operator)(?<!operator=)(?<!operator!)=", statement)[0]
            skipped = re.match(r"\s*(?:using|typedef|friend|static_assert|template\s*friend)\b", head)
            functions += not skipped and bool(re.search(r"(?:\w|operator\W{1,3})\s*\(", head))
        found.append((match.group(1), text.count("\n", 0, match.start()) + 1, functions))
    return found


def bodies(text):
    """(first line, number of lines) of the outermost functions with a body; the text's literals and comments are blanked first."""
    blank = lambda match: re.sub(r"[^\n]", " ", match.group())
    text = re.sub(r'//[^\n]*|/\*.*?\*/|R"(\w*)\(.*?\)\1"|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])\'(?!\w)', blank, text, flags=re.S)
    text = re.sub(r"^[ \t]*#[^\n]*", blank, text, flags=re.M)
    found, stack, begin = [], [], 0
    for match in re.finditer("[{};]", text):
        k, c = match.start(), match.group()
        if c == "{":
            head = text[begin:k]
            if "function" in stack or "other" in stack:
                stack.append("other")
            elif re.search(r"\)[^=;]*$", head) and not re.search(r"\b(?:namespace|enum)\b", head):
                stack.append("function")
                start = begin + len(head) - len(head.lstrip())
            else:
                stack.append("scope" if re.search(r"\b(?:namespace|class|struct|union|extern)\b", head) else "other")
            begin = k + 1
        elif c == "}":
            if stack and stack.pop() == "function":
                found.append((text.count("\n", 0, start) + 1, text.count("\n", start, k) + 1))
            begin = k + 1
        elif c == ";":
            begin = k + 1
    return found


def check_lengths(path, text):
    """What of one file is too long."""
    ours = path.parts[0] in HOUSE
    n, most = len(text.splitlines()), LONGEST if ours and path.as_posix() not in LONG_FILES else LONGEST_ELSEWHERE
    found = [f"{path}: {n} lines, at most {most} are allowed"] if n > most else []
    if path.suffix not in (".cpp", ".hpp"):
        return found
    for name, line, functions in members_of_classes(text):
        most = MOST_FOR_A_REASON if not ours or name in LARGE_CLASSES else MOST_MEMBERS
        if functions > most:
            found.append(f"{path}:{line}: {name} has {functions} member functions, at most {most} are allowed: split it by what it does")
    if ours:
        found += [f"{path}:{line}: a function of {n} lines, at most {LONGEST_FUNCTION} are allowed: split it by what it describes"
                  for line, n in bodies(text) if n > LONGEST_FUNCTION]
    return found
