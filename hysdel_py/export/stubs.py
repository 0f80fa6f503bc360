"""Names of a model as a Python module, so that an editor completes them and a type checker refuses wrong ones.

States, inputs and outputs become named tuples whose fields stand in the order of the vectors, so that a value of one is
a vector; the field of an element such as ``level(2)`` is ``level_2``. Parameters become a typed dictionary for
``load(..., **parameters)``.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from keyword import iskeyword

from hysdel_py.export.identifiers import element_of, identifiers

__all__ = ["Field", "stub_module"]

_TAKEN = frozenset(dir(tuple)) | {"_asdict", "_fields", "_make", "_replace"}


@dataclass(frozen=True, slots=True)
class Field:
    """A variable or parameter.

    Attributes
    ----------
    name : str
    is_bool : bool
    unit, description : str
    required : bool
        Whether a value has to be given; of parameters only.
    axes : int
        1 for a vector, 2 for a matrix; of parameters only, for variables come by element.
    """

    name: str
    is_bool: bool = False
    unit: str = ""
    description: str = ""
    required: bool = True
    axes: int = 0

    @property
    def type(self) -> str:
        """Name of the Python type."""
        return "Sequence[" * self.axes + ("bool" if self.is_bool else "float") + "]" * self.axes

    @property
    def words(self) -> str:
        """Description and unit on one line."""
        return " ".join(part for part in (self.description, f"[{self.unit}]" if self.unit else "") if part)


def stub_module(name: str, vectors: Mapping[str, Sequence[Field]], parameters: Sequence[Field]) -> str:
    """Text of the module.

    Parameters
    ----------
    name : str
        Name of the model; the classes are called after it.
    vectors : mapping of str to sequence of Field
        Word for each vector, as in ``"State"``, with its variables in order.
    parameters : sequence of Field

    Examples
    --------
    >>> text = stub_module("leak", {"State": [Field("x", unit="m")]}, [])
    >>> "class LeakState(NamedTuple):" in text
    True
    """
    prefix = "".join(part[:1].upper() + part[1:] for part in name.split("_"))
    whole = _whole(parameters)
    classes = [_named_tuple(prefix, name, word, fields) for word, fields in vectors.items()]
    classes.append(_dictionary(f"{prefix}Parameters", name, whole))
    imports = ["NamedTuple", *(["Required"] if any(field.required for field in whole) else []), "TypedDict"]
    head = f'"""Names of the model {name}, written by hysdel stubs; changes will be lost."""\n\n'
    if any(field.axes for field in whole):
        head += "from collections.abc import Sequence\n"
    return head + f"from typing import {', '.join(imports)}\n\n\n" + "\n\n".join(classes)


def _whole(parameters: Sequence[Field]) -> list[Field]:
    """The parameters with the elements of a vector or matrix as one, which is given as a whole."""
    found: dict[str, Field] = {}
    for field in parameters:
        name, indices = element_of(field.name)
        required = field.required or (name in found and found[name].required)
        found[name] = replace(field, name=name, axes=len(indices), required=required)
    return list(found.values())


def _named_tuple(prefix: str, model: str, word: str, fields: Sequence[Field]) -> str:
    lines = [f"class {prefix}{word}(NamedTuple):", f'    """{word} vector of {model}."""', ""]
    named = identifiers((field.name for field in fields), lambda name: iskeyword(name) or name in _TAKEN)
    for field in fields:
        original = f"{field.name}: " if not field.name.isidentifier() else ""
        lines += _member(named[field.name], field.type, (original + field.words).removesuffix(": "))
    return "\n".join(lines) + "\n"


def _member(name: str, type_: str, words: str) -> Iterator[str]:
    yield f"    {name}: {type_}"
    if words:
        yield f'    """{_harmless(words)}"""'


def _harmless(words: str) -> str:
    """Text that can stand between triple quotes."""
    return words.replace("\\", "\\\\").replace('"', "'")


def _dictionary(name: str, model: str, fields: Sequence[Field]) -> str:
    if any(iskeyword(field.name) or not field.name.isidentifier() for field in fields):
        return _dictionary_by_call(name, fields)
    lines = [f"class {name}(TypedDict, total=False):", f'    """Parameters of {model}."""', ""]
    for field in fields:
        lines += _member(field.name, _parameter_type(field), field.words)
    return "\n".join(lines) + "\n"


def _dictionary_by_call(name: str, fields: Sequence[Field]) -> str:
    """The form for keys that are words of Python or lie in a module; it has no place for descriptions."""
    members = "".join(f'        "{field.name}": {_parameter_type(field)},\n' for field in fields)
    return f'{name} = TypedDict(\n    "{name}",\n    {{\n{members}    }},\n    total=False,\n)\n'


def _parameter_type(field: Field) -> str:
    return f"Required[{field.type}]" if field.required else field.type
