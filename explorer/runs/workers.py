"""Who computes the chunks: joblib threads (kernels release the GIL) or processes."""

from pathlib import Path

from joblib import Parallel, delayed

from explorer.errors import InputError
from explorer.runs import store
from explorer.runs.progress import Progress
from explorer.scenes.base import Scene

BACKENDS = {"threads": "threading", "processes": "loky"}


def check_workers(jobs: int, backend: str) -> None:
    """Raise InputError for a number of jobs or a backend that cannot be used."""
    if isinstance(jobs, bool) or not isinstance(jobs, int) or jobs < 1:
        raise InputError(f"--jobs {jobs} must be a whole number, 1 or more")
    if backend not in BACKENDS:
        raise InputError(f"--backend {backend!r} is not known; choose {' or '.join(BACKENDS)}")


def compute_chunks(scene: Scene, folder: Path, jobs: int, backend: str, progress: Progress) -> int:
    """Compute and store every chunk that is missing or damaged; returns how many."""
    missing = [i for i in range(scene.chunks()) if not store.is_intact(store.chunk_path(folder, i))]
    for _ in range(scene.chunks() - len(missing)):
        progress.advance()
    pool = Parallel(
        n_jobs=min(jobs, max(1, len(missing))), backend=BACKENDS[backend], return_as="generator_unordered"
    )
    for _ in pool(delayed(_compute_chunk)(scene, index, folder) for index in missing):
        progress.advance()
    return len(missing)


def _compute_chunk(scene: Scene, index: int, folder: Path) -> None:
    store.write_chunk(store.chunk_path(folder, index), scene.compute(index))
