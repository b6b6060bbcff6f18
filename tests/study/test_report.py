"""report.json and report.csv: what they hold, and that they read back."""

from __future__ import annotations

import csv
import io
import json
import re
from pathlib import Path

import pytest

from culet.errors import InputError
from culet.study.findings.headline import BEGIN, END, headline_markdown, write_into
from culet.study.pages.page import page
from culet.study.report import Report, csv_text
from study.reports import report

DOCUMENTED = Path(__file__).parents[2] / "docs" / "explanation" / "study.md"


def test_a_report_reads_back_as_it_was(tmp_path: Path) -> None:
    (tmp_path / "report.json").write_text(report().json_text())
    assert Report.read(tmp_path / "report.json") == report()


def test_an_earlier_report_that_calls_frontiers_fronts_is_read(tmp_path: Path) -> None:
    path = tmp_path / "report.json"
    path.write_text(report().json_text().replace('"frontiers"', '"fronts"'), encoding="utf-8")
    assert '"fronts"' in path.read_text(encoding="utf-8")
    assert Report.read(path) == report()


def test_the_schema_that_is_documented_is_the_one_that_is_written() -> None:
    section = DOCUMENTED.read_text().split("\n## report.json\n")[1].split("\n## ")[0]
    assert re.findall(r"^\| `(\w+)` \|", section, re.MULTILINE) == list(Report.model_fields)


def test_another_schema_is_refused_with_the_place(tmp_path: Path) -> None:
    written = json.loads(report().json_text())
    (tmp_path / "r.json").write_text(json.dumps({**written, "schema_version": 2}))
    with pytest.raises(InputError, match="schema_version"):
        Report.read(tmp_path / "r.json")
    (tmp_path / "r.json").write_text("{")
    with pytest.raises(InputError, match="no report"):
        Report.read(tmp_path / "r.json")
    with pytest.raises(InputError, match="cannot read"):
        Report.read(tmp_path / "missing.json")


def test_every_point_is_a_row_with_all_knobs_and_figures() -> None:
    rows = list(csv.DictReader(io.StringIO(csv_text(report()))))
    assert [row["samples"] for row in rows] == ["1", "4"]
    assert [float(row["frame_seconds"]) for row in rows] == [0.5, 2.0]
    assert rows[0]["cut"] == ""


def test_the_page_needs_nothing_from_elsewhere(tmp_path: Path) -> None:
    text = page(report(), tmp_path)
    assert not re.search(r"""https?:|src="(?!data:)|<link|<script|@import|url\(""", text)


def test_the_page_shows_the_frontier_and_escapes_what_it_was_given(tmp_path: Path) -> None:
    text = page(report(), tmp_path)
    assert "<b> & so on" not in text
    assert text.count("samples 4, &lt;b&gt; &amp; so on") >= 3  # in the plot, the frontier's table and the knobs' table
    assert 'class="number">2</text>' in text  # the frontier's second point is numbered


def test_the_headlines_are_a_table_with_their_provenance() -> None:
    text = headline_markdown(report())
    assert "| a frame | 1.23 ms |" in text
    assert "Measured on P, abc, 2026-01-02." in text


def test_they_take_the_place_of_what_is_between_the_marks(tmp_path: Path) -> None:
    readme = tmp_path / "README.md"
    readme.write_text(f"before\n{BEGIN}\nold\n{END}\nafter\n")
    for _ in range(2):  # as often as one likes
        write_into(readme, "| new |\n")
        assert readme.read_text() == f"before\n{BEGIN}\n\n| new |\n\n{END}\nafter\n"


@pytest.mark.parametrize("content", ["nothing", BEGIN, f"{END}\n{BEGIN}", f"{BEGIN}{END}{BEGIN}{END}"])
def test_a_file_without_one_pair_of_marks_is_left_alone(tmp_path: Path, content: str) -> None:
    readme = tmp_path / "README.md"
    readme.write_text(content)
    with pytest.raises(InputError, match="culet study headline"):
        write_into(readme, "new")
    assert readme.read_text() == content


def test_the_document_has_a_place_for_them() -> None:
    text = DOCUMENTED.read_text(encoding="utf-8")
    assert text.count(BEGIN) == text.count(END) == 1
