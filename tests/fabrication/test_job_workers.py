"""Workers that die: what was lost runs again alone, and only what kills its worker is given up."""

from __future__ import annotations

import os
import signal
from pathlib import Path

import pytest
from roofs import barrel

from fabrication.formats.base import Format, Part
from fabrication.gridshell.design import design
from fabrication.job import steps
from fabrication.job.part import Shop, read_back
from fabrication.job.pool import WorkerLostError, worker_pool
from fabrication.job.run import make
from fabrication.specs import Check

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(os.name != "posix", reason="kills by signals"),
]


def test_a_lost_worker_costs_only_the_call_that_kills_it(tmp_path: Path) -> None:
    mark = tmp_path / "once"
    once = f"open({str(mark)!r}, 'x') and __import__('os')._exit(9)"
    with worker_pool(2, kernel=False) as pool:
        first = pool.submit(eval, once)  # the second time it raises what `open` raises
        always = pool.submit(os._exit, 9)
        others = [pool.submit(abs, -k) for k in range(50)]
        assert [other.result(timeout=120) for other in others] == list(range(50))
        with pytest.raises(FileExistsError):
            first.result(timeout=120)
        with pytest.raises(WorkerLostError, match="probably out of memory; try --jobs 1"):
            always.result(timeout=120)
        assert pool.submit(abs, -7).result(timeout=120) == 7


def killing(parts: list[Part], shop: Shop) -> tuple[dict[str, list[Check]], float]:
    """Reading back, in which one part number ends the process."""
    if any(part.number == "BP-001" for part in parts):
        os.kill(os.getpid(), signal.SIGKILL)
    return read_back(parts, shop)


def test_a_part_that_no_worker_survives_is_rejected_and_the_job_goes_on(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.syspath_prepend(str(Path(__file__).parent))
    monkeypatch.setattr(steps, "read_back", killing)
    made = design(barrel(1, 2), output={"formats": ["stl"]}, checks={"verify": "all"})
    result = make(made, tmp_path / "out", jobs=2)
    lost = {
        part["number"]
        for part in result.manifest["parts"]
        if any(check["name"] == "file readable" and not check["passed"] for check in part["checks"])
    }
    assert lost == {"BP-001"}
    assert any("a worker was killed" in problem for problem in result.problems)
    assert (tmp_path / "out" / "rejected" / "stl" / "BP-001.stl").exists()
    assert len({part["number"] for part in result.manifest["parts"]}) > 2


class Fatal(Format):
    """A format whose files cannot be written by any process."""

    name = "fatal"
    suffixes = (".fatal",)

    def write_whole(self, folder: Path, whole: object) -> list[str]:
        os.kill(os.getpid(), signal.SIGKILL)
        return []


def test_a_file_of_the_whole_that_no_worker_survives_ends_the_job(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from fabrication.formats import registry

    monkeypatch.syspath_prepend(str(Path(__file__).parent))
    registry.register(Fatal())
    try:
        made = design(barrel(1, 2), output={"formats": ["fatal"]}, checks={"verify": "none"})
        with pytest.raises(WorkerLostError, match="fatal of the whole: a worker was killed"):
            make(made, tmp_path / "out", jobs=2)
    finally:
        registry.unregister("fatal")
    assert list(tmp_path.iterdir()) == []
