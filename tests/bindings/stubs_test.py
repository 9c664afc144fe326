#!/usr/bin/env python3
"""The type stubs against the module: stubs_test.py _runtime.pyi FOLDER_OF_THE_PACKAGE. Each class, method, property and
argument, with its default or without, is in both."""
import ast
import inspect
import re
import sys

stubs, folder = sys.argv[1:]
sys.path.insert(0, folder)
from fascia import _runtime

failures = []


def public(names):
    return {name for name in names if not name.startswith("_") or name == "__init__"}


def arguments_of_stub(function, is_static):
    """[(name, has a default)], without self."""
    every = function.args.posonlyargs + function.args.args
    first_default = len(every) - len(function.args.defaults)
    listed = [(argument.arg, i >= first_default) for i, argument in enumerate(every)]
    return listed if is_static else listed[1:]


def arguments_of_module(function, is_static):
    """The same of pybind11's signature, the first line of its documentation."""
    line = (function.__doc__ or "").splitlines()[0]
    inside = re.match(r"\w+\((.*)\) -> ", line).group(1)
    listed, depth, start = [], 0, 0
    for i, letter in enumerate(inside + ","):
        depth += (letter in "[({<") - (letter in "])}>")
        if letter == "," and depth == 0 and inside[start:i].strip():
            part = inside[start:i].strip()
            listed.append((re.split(r"[:=]", part)[0].strip(), " = " in part))
            start = i + 1
    return listed if is_static else listed[1:]


def compare_function(where, stub, function, is_static):
    expected, found = arguments_of_stub(stub, is_static), arguments_of_module(function, is_static)
    if expected != found:
        failures.append(f"{where}: the stub has {expected}, the module {found}")


def compare_class(stub, found):
    members = {node.name: node for node in stub.body if isinstance(node, ast.FunctionDef)}
    there = public(name for name in vars(found))
    if issubclass(found, Exception):
        return
    if "__init__" not in members:  # made by other functions only
        there.discard("__init__")
    for name in sorted(public(members) ^ there):
        failures.append(f"{stub.name}.{name} is only in the {'stub' if name in members else 'module'}")
    for name in sorted(public(members) & there):
        decorators = {ast.unparse(decorator) for decorator in members[name].decorator_list}
        member = inspect.getattr_static(found, name)
        if ("property" in decorators) != isinstance(member, property):
            failures.append(f"{stub.name}.{name}: a property in one, a method in the other")
        elif "property" not in decorators:
            compare_function(f"{stub.name}.{name}", members[name], getattr(found, name), "staticmethod" in decorators)


with open(stubs) as file:
    tree = ast.parse(file.read())
described = {node.name: node for node in tree.body if isinstance(node, (ast.ClassDef, ast.FunctionDef))}
for name in sorted(public(described) ^ public(vars(_runtime))):
    failures.append(f"{name} is only in the {'stub' if name in described else 'module'}")
for name, node in described.items():
    if not hasattr(_runtime, name):
        continue
    if isinstance(node, ast.ClassDef):
        compare_class(node, getattr(_runtime, name))
    else:
        compare_function(name, node, getattr(_runtime, name), True)
print("\n".join(failures) or f"stubs: {len(described)} classes and functions are the module's")
sys.exit(bool(failures))
