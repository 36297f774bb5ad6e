"""Expressions of constants are their values; what adds nothing or multiplies by 1 is left out."""

import ast
import math

from crashkit.mechanics.laws.program import names_in


def evaluated(expression: ast.expr) -> float:
    """The value of an expression of constants."""
    code = compile(ast.fix_missing_locations(ast.Expression(expression)), "<constant>", "eval")
    return float(eval(code, {"math": math}))


def folded(expression: ast.expr) -> ast.expr:
    """A shorter expression of the same value, if there is one."""
    if not names_in(expression):
        try:
            return ast.Constant(evaluated(expression))
        except (ArithmeticError, ValueError):
            return expression
    match expression:
        case ast.UnaryOp(op=ast.UAdd(), operand=operand):
            return operand
        case ast.BinOp(left=ast.Constant(value=0.0), op=ast.Add(), right=other):
            return other
        case ast.BinOp(left=other, op=ast.Add() | ast.Sub(), right=ast.Constant(value=0.0)):
            return other
        case ast.BinOp(left=ast.Constant(value=0.0), op=ast.Sub(), right=other):
            return ast.UnaryOp(ast.USub(), other)
        case ast.BinOp(left=ast.Constant(value=1.0), op=ast.Mult(), right=other):
            return other
        case ast.BinOp(left=other, op=ast.Mult() | ast.Div() | ast.Pow(), right=ast.Constant(value=1.0)):
            return other
    return expression
