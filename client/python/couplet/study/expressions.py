# SPDX-License-Identifier: Apache-2.0
"""Expressions of a case file: numbers, names, + - * / ^, comparisons and a few functions, nothing else of Python."""
import ast
import operator

LONGEST = 2000  # characters
BINARY = {ast.Add: operator.add, ast.Sub: operator.sub, ast.Mult: operator.mul, ast.Div: operator.truediv, ast.Pow: operator.pow}
UNARY = {ast.USub: operator.neg, ast.UAdd: operator.pos}
COMPARE = {ast.Lt: operator.lt, ast.LtE: operator.le, ast.Gt: operator.gt, ast.GtE: operator.ge, ast.Eq: operator.eq, ast.NotEq: operator.ne}


def evaluate(text, names, functions=()):
    """The value of an expression of `names` ({name: number or array}) and `functions` ({name: callable}). Raises ValueError for
    anything else, with what it is. Numbers are floats: no power grows without end."""
    text = str(text)
    if len(text) > LONGEST:
        raise ValueError(f"an expression of more than {LONGEST} characters")
    functions = dict(functions)

    def value(node):
        if isinstance(node, ast.Constant) and type(node.value) in (int, float):
            return float(node.value)
        if isinstance(node, ast.Name) and node.id in names:
            return names[node.id]
        if isinstance(node, ast.UnaryOp) and type(node.op) in UNARY:
            return UNARY[type(node.op)](value(node.operand))
        if isinstance(node, ast.BinOp) and type(node.op) in BINARY:
            return BINARY[type(node.op)](value(node.left), value(node.right))
        if isinstance(node, ast.Compare) and len(node.ops) == 1 and type(node.ops[0]) in COMPARE:
            return COMPARE[type(node.ops[0])](value(node.left), value(node.comparators[0]))
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id in functions and not node.keywords:
            if any(isinstance(a, ast.Starred) for a in node.args):
                raise ValueError("'*' before an argument")
            return functions[node.func.id](*map(value, node.args))
        raise ValueError(f"'{ast.unparse(node)[:60]}'; valid are numbers, + - * / ^, comparisons and {', '.join([*names, *functions])}")

    try:
        return value(ast.parse(text.strip().replace("^", "**"), mode="eval").body)
    except (SyntaxError, TypeError, ArithmeticError, RecursionError, MemoryError) as error:
        raise ValueError(f"{type(error).__name__}: {error}") from error
