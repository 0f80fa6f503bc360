"""Time and memory of every stage of the compiler on models of n coupled tanks.

    python benchmarks/scale.py [--tanks 1 2 5 10 20 50 100 200] [--style scalar vector] [--repeat 3] [--profile STAGE]

Each model is written once with a name for every scalar and once with vectors and FOR. A row of the table is one model:
CPU milliseconds of each stage (the least of the repeats), the sum, its ratio to the sum of the shipped clutch in the
same run, and the growth exponent of the sum over rows against the model before. The ratio is what travels between
machines. A second table holds the peak of traced memory of each stage in kilobytes, taken in a run of its own.
"""

from __future__ import annotations

import argparse
import cProfile
import math
import pstats
import sys
import time
import tracemalloc
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from hysdel_py.compiler import lower_to_dha, lower_to_mld
from hysdel_py.diagnostics.sink import Sink
from hysdel_py.elaboration.elaborate import elaborate
from hysdel_py.elaboration.modules import load_modules
from hysdel_py.export.compiled import Compiled
from hysdel_py.export.matlab import MatlabOptions, matlab_text
from hysdel_py.export.matrices import json_text
from hysdel_py.export.simulator_python import module_text
from hysdel_py.lowering.big_m import BigM
from hysdel_py.lowering.constants import Constants
from hysdel_py.semantics.lints import note_unused_parameters
from hysdel_py.semantics.parameters import bind_parameters
from hysdel_py.semantics.resolve import resolve
from hysdel_py.shipped import shipped_models
from hysdel_py.syntax.formatter import format_text
from hysdel_py.syntax.parser import parse_what_is_sound
from hysdel_py.syntax.reader import read_source

TANKS = (1, 2, 5, 10, 20, 50, 100, 200)
STAGES = ("parse", "elaborate", "types", "dha", "mld", "matlab", "json", "python", "fmt", "dha step", "mld step")

PARAMETERS = """      REAL ts = 2, area = 1.5, h_max = 6, q_max = 0.1, k_pipe = 0.02, k_out = 0.01;
"""

SCALAR_DECLARED = {
    "STATE": "REAL h_{i} [0, h_max];   /* [dm] level */\n      BOOL alarm_{i};",
    "INPUT": "REAL q_{i} [0, q_max];   /* [dm^3/s] flow of the pump */\n      BOOL valve_{i};",
    "OUTPUT": "REAL level_{i};",
}
SCALAR_AUX = """      BOOL high_{i}, above_{i}, drain_{i};
      REAL flow_{i};   /* [dm^3/s] to the next tank */
      REAL out_{i};    /* [dm^3/s] through the drain */
      REAL net_{i};"""
SCALAR_ITEMS = (
    ("AD", "high_{i} = h_{i} >= 0.9*h_max;\n      above_{i} = h_{i} >= {next};"),
    ("LOGIC", "drain_{i} = high_{i} | (valve_{i} & above_{i});"),
    (
        "DA",
        "flow_{i} = {{IF above_{i} THEN k_pipe*(h_{i} - {next}) ELSE 0}};\n"
        "      out_{i} = {{IF drain_{i} THEN k_out*h_{i} ELSE 0}};",
    ),
    ("LINEAR", "net_{i} = q_{i} + {before} - flow_{i} - out_{i};"),
    ("CONTINUOUS", "h_{i} = h_{i} + ts/area*net_{i};"),
    ("AUTOMATA", "alarm_{i} = (alarm_{i} | high_{i}) & ~drain_{i};"),
    ("OUTPUT", "level_{i} = h_{i};"),
    ("MUST", "high_{i} -> ~valve_{i};\n      q_{i} + k_pipe*h_{i} <= 2*q_max;"),
)

VECTOR = """SYSTEM tanks {{
  INTERFACE {{
    PARAMETER {{
      REAL n = {n};
{parameters}    }}
    STATE {{
      REAL h(n) [0, h_max];   /* [dm] level */
      BOOL alarm(n);
    }}
    INPUT {{
      REAL q(n) [0, q_max];   /* [dm^3/s] flow of a pump */
      BOOL valve(n);
    }}
    OUTPUT {{
      REAL level(n);
    }}
  }}
  IMPLEMENTATION {{
    AUX {{
      INDEX i;
      BOOL high(n), above(n), drain(n);
      REAL flow(n);   /* [dm^3/s] to the next tank */
      REAL out(n);    /* [dm^3/s] through the drain */
      REAL net(n);
    }}
    AD {{
      high = h >= 0.9*h_max;
      FOR (i = 1:n - 1) {{ above(i) = h(i) >= h(i + 1); }}
      above(n) = h(n) >= 0;
    }}
    LOGIC {{
      drain = high | (valve & above);
    }}
    DA {{
      FOR (i = 1:n - 1) {{ flow(i) = {{IF above(i) THEN k_pipe*(h(i) - h(i + 1)) ELSE 0}}; }}
      flow(n) = {{IF above(n) THEN k_pipe*h(n) ELSE 0}};
      out = {{IF drain THEN k_out*h ELSE 0}};
    }}
    LINEAR {{
      net(1) = q(1) - flow(1) - out(1);
      FOR (i = 2:n) {{ net(i) = q(i) + flow(i - 1) - flow(i) - out(i); }}
    }}
    CONTINUOUS {{
      h = h + ts/area*net;
    }}
    AUTOMATA {{
      alarm = (alarm | high) & ~drain;
    }}
    OUTPUT {{
      level = h;
    }}
    MUST {{
      high -> ~valve;
      q + k_pipe*h <= 2*q_max;
    }}
  }}
}}
"""


def vector_text(n: int) -> str:
    """Tanks as vectors."""
    return VECTOR.format(n=n, parameters=PARAMETERS)


def scalar_text(n: int) -> str:
    """Tanks with a name for every scalar."""

    def each(template: str) -> str:
        return "".join(
            "      "
            + template.format(
                i=i,
                next=f"h_{i + 1}" if i < n else "0",
                before=f"flow_{i - 1}" if i > 1 else "0",
            ).strip()
            + "\n"
            for i in range(1, n + 1)
        )

    declared = "".join(f"    {kind} {{\n{each(text)}    }}\n" for kind, text in SCALAR_DECLARED.items())
    items = "".join(f"    {kind} {{\n{each(text)}    }}\n" for kind, text in SCALAR_ITEMS)
    return (
        f"SYSTEM tanks {{\n  INTERFACE {{\n    PARAMETER {{\n{PARAMETERS}    }}\n{declared}  }}\n"
        f"  IMPLEMENTATION {{\n    AUX {{\n{each(SCALAR_AUX)}    }}\n{items}  }}\n}}\n"
    )


STYLES = {"scalar": scalar_text, "vector": vector_text}


@dataclass
class Run:
    """One text taken through all stages; what a stage makes is kept for those behind it."""

    text: str
    observe: Callable[[str, Callable[[], Any]], Any]
    made: dict[str, Any] = field(default_factory=dict)

    def all_stages(self) -> Run:
        for stage in STAGES:
            self.made[stage] = self.observe(stage, getattr(self, stage.replace(" ", "_")))
        return self

    def parse(self) -> Any:
        source = read_source(self.text, Sink())
        return source, parse_what_is_sound(source, Sink()).system

    def elaborate(self) -> Any:
        source, system = self.made["parse"]
        instances, source = load_modules(system, source, (), Sink())
        return source, *elaborate(instances, {}, Sink())

    def types(self) -> Any:
        source, system, given = self.made["elaborate"]
        sink = Sink()
        model = resolve(system, source, sink)
        values = bind_parameters(model, given, sink)
        note_unused_parameters(model, sink)
        sink.raise_errors(source)
        return model, values

    def dha(self) -> Any:
        return lower_to_dha(*self.made["types"], Constants.AFFINE)[0]

    def mld(self) -> Any:
        return lower_to_mld(self.made["types"][0], self.made["dha"], BigM.INTERVAL)[0]

    def matlab(self) -> Any:
        model, values = self.made["types"]
        compiled = Compiled(model, values, self.made["dha"], self.made["mld"], Constants.AFFINE)
        return matlab_text(compiled, MatlabOptions())

    def json(self) -> Any:
        return json_text(self.made["mld"])

    def python(self) -> Any:
        return module_text(self.made["types"][0], self.made["dha"])

    def fmt(self) -> Any:
        return format_text(self.text)

    def point(self) -> tuple[Any, Any]:
        """A state and input near the lower ends of the ranges, where no requirement is in the way."""
        dha = self.made["dha"]
        return tuple(
            np.array([0.0 if v.is_bool else v.low + 0.3 * (v.high - v.low) for v in group]) for group in (dha.x, dha.u)
        )  # fmt: skip

    def dha_step(self) -> Any:
        return self.made["dha"].step(*self.point(), check=False)

    def mld_step(self) -> Any:
        return self.made["mld"].step(*self.point(), check=False)


def seconds_of(text: str, repeat: int) -> tuple[dict[str, float], Run]:
    """Least processor time of each stage, and the last run."""
    best = dict.fromkeys(STAGES, math.inf)

    def timed(stage: str, work: Callable[[], Any]) -> Any:
        start = time.process_time()
        made = work()
        best[stage] = min(best[stage], time.process_time() - start)
        return made

    run = Run(text, timed)
    for _ in range(repeat):
        run = Run(text, timed).all_stages()
    return best, run


def memory_of(text: str) -> dict[str, float]:
    """Peak of traced memory of each stage over what was there before it, in bytes."""
    peaks: dict[str, float] = {}

    def traced(stage: str, work: Callable[[], Any]) -> Any:
        tracemalloc.reset_peak()
        before = tracemalloc.get_traced_memory()[0]
        made = work()
        peaks[stage] = tracemalloc.get_traced_memory()[1] - before
        return made

    tracemalloc.start()
    try:
        Run(text, traced).all_stages()
    finally:
        tracemalloc.stop()
    return peaks


def exponent(before: tuple[float, float] | None, now: tuple[float, float]) -> str:
    """Slope between two points (rows, seconds) on logarithmic axes."""
    if before is None or before[0] >= now[0]:
        return ""
    return f"{math.log(now[1] / before[1]) / math.log(now[0] / before[0]):.2f}"


def head(first: str, last: tuple[str, ...] = ()) -> str:
    names = (first, "rows", "columns", *STAGES, *last)
    return "| " + " | ".join(names) + " |\n|" + "---|" + "---:|" * (len(names) - 1)


def table_row(name: str, run: Run, figures: dict[str, float], scale: float, last: tuple[str, ...] = ()) -> str:
    mld = run.made["mld"]
    columns = mld.nx + mld.nu + mld.nd + mld.nz
    cells = (f"{figures[stage] * scale:.{1 if scale == 1e3 else 0}f}" for stage in STAGES)
    return "| " + " | ".join((name, str(mld.ne), str(columns), *cells, *last)) + " |"


def profile(text: str, stage: str) -> None:
    """Where one stage spends its time."""

    def profiled(name: str, work: Callable[[], Any]) -> Any:
        if name != stage:
            return work()
        profiler = cProfile.Profile()
        made = profiler.runcall(work)
        pstats.Stats(profiler).sort_stats("tottime").print_stats(20)
        return made

    Run(text, profiled).all_stages()


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--tanks", type=int, nargs="+", default=TANKS)
    parser.add_argument("--style", nargs="+", choices=STYLES, default=tuple(STYLES))
    parser.add_argument("--repeat", type=int, default=3)
    parser.add_argument("--profile", choices=STAGES, help="profile this stage for the largest model instead")
    options = parser.parse_args()
    if options.profile:
        profile(STYLES[options.style[0]](max(options.tanks)), options.profile)
        return 0
    clutch = shipped_models()["clutch"].read_text(encoding="utf-8")
    seconds_of(clutch, 1)  # imports, and the tables of the parser
    reference, run = seconds_of(clutch, max(5, options.repeat))
    unit = sum(reference.values())
    print(head("model", ("sum", "ratio", "growth")))
    print(table_row("clutch", run, reference, 1e3, (f"{unit * 1e3:.0f}", "1.0", "")))
    memory = [table_row("clutch", run, memory_of(clutch), 1e-3)]
    for style in options.style:
        before = None
        for n in options.tanks:
            text = STYLES[style](n)
            figures, run = seconds_of(text, options.repeat)
            total = sum(figures.values())
            now = (run.made["mld"].ne, total)
            last = (f"{total * 1e3:.0f}", f"{total / unit:.1f}", exponent(before, now))
            print(table_row(f"{style} {n}", run, figures, 1e3, last), flush=True)
            memory.append(table_row(f"{style} {n}", run, memory_of(text), 1e-3))
            before = now
    print("\nPeak of memory in kB:\n")
    print("\n".join((head("model"), *memory)))
    return 0


if __name__ == "__main__":
    sys.exit(main())
