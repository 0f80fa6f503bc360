"""The program inside the C source of a plant that replays steps and fails where one differs."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from hysdel_py.export.c_text import array, float_text
from hysdel_py.export.plant_points import ReplayStep
from hysdel_py.systems.dha import Dha

__all__ = ["plant_test"]

_ACCURACY = "1e-12"

_DIFFERENT = """
static int different(const double *ours, const double *theirs, int count)
{{
    int i;
    for (i = 0; i < count; i++) {{
        const double room = {accuracy} * (1.0 + (theirs[i] < 0.0 ? -theirs[i] : theirs[i]));
        if (!(ours[i] - theirs[i] <= room && theirs[i] - ours[i] <= room))
            return 1;
    }}
    return 0;
}}
"""

_MAIN = """
/* 0 if the step agrees with the replayed ones. */
int main(void)
{{
    int k, wrong = 0;
    for (k = 0; k < {count}; k++) {{
        double x1[{x}], y[{y}], d[{d}], z[{z}];
        int bad = {name}_step(replay_x[k], replay_u[k], x1, y, d, z) != replay_status[k];
{compared}\
        if (bad)
            printf("step %d differs\\n", k);
        wrong += bad;
    }}
    printf("%d of {count} steps differ\\n", wrong);
    return wrong != 0;
}}
"""


def plant_test(dha: Dha, name: str, steps: Sequence[ReplayStep]) -> Iterator[str]:
    """Lines of the program, compiled where a macro asks for it; none without steps."""
    if not steps:
        return
    sizes = {"x": len(dha.x), "u": len(dha.u), "y": len(dha.y), "d": len(dha.d), "z": len(dha.z)}
    tables = {"x": "x", "u": "u", "x1": "x", "y": "y", "d": "d", "z": "z"}
    yield f"#ifdef {name.upper()}_SELF_TEST"
    yield "#include <stdio.h>"
    yield ""
    for field, key in tables.items():
        if sizes[key] or field in "xu":
            rows = [_row(getattr(step, field).tolist()) for step in steps]
            yield from array(f"double replay_{field}[{len(steps)}][{max(1, sizes[key])}]", rows)
    states = [" | ".join(f"{name.upper()}_{bit}" for bit in step.violated) or "0" for step in steps]
    yield from array(f"int replay_status[{len(steps)}]", states)
    compared = [field for field, key in tables.items() if sizes[key] and field not in "xu"]
    words = {key: str(max(1, size)) for key, size in sizes.items()} | {"name": name, "count": str(len(steps))}
    words["compared"] = "".join(
        f"        bad = bad || different({field}, replay_{field}[k], {sizes[tables[field]]});\n" for field in compared
    )
    if compared:
        yield from _DIFFERENT.format(accuracy=_ACCURACY).removesuffix("\n").split("\n")
    yield from _MAIN.format(**words).removesuffix("\n").split("\n")
    yield "#endif"


def _row(values: Sequence[float]) -> str:
    return "{" + ", ".join(map(float_text, values or [0.0])) + "}"
