# SPDX-License-Identifier: Apache-2.0
"""Code of Python as text: comments, docstrings, type hints and layout do not count, nor does the version of Python."""

import ast


def bare(tree: ast.Module) -> list[ast.AST]:
    """Take the docstrings and the type hints out of a tree, and return its nodes."""
    nodes = list(ast.walk(tree))
    for node in nodes:
        if isinstance(node, ast.arg | ast.AnnAssign):
            node.annotation = ast.Constant(None)  # a field of a class stays one
        elif isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef)):
            node.returns = None
        if isinstance(body := getattr(node, "body", None), list):
            body[:] = [
                each for each in body if not (isinstance(each, ast.Expr) and isinstance(each.value, ast.Constant))
            ]
    return nodes


def code(value: object) -> str:
    """Return a tree of Python as text, the same in every version of Python."""
    if isinstance(value, ast.AST):
        fields = [f"{name}={code(each)}" for name, each in ast.iter_fields(value) if each is not None and each != []]
        return f"{type(value).__name__}({','.join(fields)})"
    return f"[{','.join(map(code, value))}]" if isinstance(value, list) else repr(value)


def code_of(text: str) -> str:
    """Return the code of a file of Python."""
    bare(tree := ast.parse(text))
    return code(tree)
