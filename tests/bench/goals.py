# SPDX-License-Identifier: Apache-2.0
"""Goals of a benchmark's figures: "KEY <= NUMBER", where dots lead into objects and * stands for each key or element."""
import operator
import re

GOAL = re.compile(r"([\w.*-]+) (<=|>=|==) (-?[\d.]+(?:e-?\d+)?)")
RELATIONS = {"<=": operator.le, ">=": operator.ge, "==": operator.eq}


def parse(goal):
    """The path, the relation and the number; raises ValueError."""
    match = GOAL.fullmatch(goal)
    if not match:
        raise ValueError(f"'{goal}' is no goal; write KEY <= NUMBER")
    return match[1].split("."), match[2], float(match[3])


def values_at(path, result):
    """Every value that a path leads to."""
    if not path:
        return [result]
    if path[0] == "*":
        inner = result.values() if isinstance(result, dict) else result if isinstance(result, list) else []
        return [value for child in inner for value in values_at(path[1:], child)]
    if isinstance(result, dict) and path[0] in result:
        return values_at(path[1:], result[path[0]])
    return []


def is_held(goal, result):
    """Whether every figure that a goal names holds it; None without such a figure."""
    path, relation, limit = parse(goal)
    values = [value for value in values_at(path, result) if isinstance(value, (int, float))]
    return all(RELATIONS[relation](value, limit) for value in values) if values else None
