"""The report of a replay as one HTML file that needs nothing else."""

from html import escape
from typing import Any

from studies.replay.plots import picture
from studies.replay.table import table

_STYLE = """\
body { font: 15px/1.45 sans-serif; color: #111; background: #fff; max-width: 1080px; margin: 2em auto; padding: 0 1em }
h1 { font-size: 1.35em; margin-bottom: 0.2em } p { margin: 0.3em 0 } pre { overflow-x: auto; font-size: 13px }
figure { margin: 1.2em 0 } svg { width: 100%; height: auto } .notes { color: #555 }
"""
_EXPLAINED = """\
The offline bound is what somebody could have gained at most who knew all samples beforehand and could send fractions
of them, in pieces of time whose borders are free; that of a type is what it could have gained if it had the limits to
itself. All of it is utility, by the specs.
"""


def page(report: dict[str, Any]) -> str:
    """Return the page. Raises ImportError without matplotlib."""
    notes = "".join(f"<p>{escape(note)}</p>" for note in report["notes"])
    title = escape(f"Replay of {', '.join(report['files'])}")
    return f"""<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width">
<meta http-equiv="Content-Security-Policy" content="default-src 'none'; style-src 'unsafe-inline'">
<title>{title}</title>
<style>
{_STYLE}</style>
</head>
<body>
<h1>{title}</h1>
<p>{escape(report["about"])}</p>
<figure>
{picture(report)}
</figure>
<pre>{escape(table(report))}</pre>
<p>{_EXPLAINED}</p>
<div class="notes">{notes}</div>
</body>
</html>
"""
