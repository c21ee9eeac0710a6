"""Compiled kernels are kept where they can be, checked when they are read, and never in the way."""

import os
import warnings
from pathlib import Path

import numba
import pytest

import raytrace.kernels
import rssnav.kernels
from raytrace.kernels import cache
from raytrace.kernels.beams import grow_tree_arrays
from raytrace.kernels.cache import KernelCache, cache_folder, sources_digest
from raytrace.kernels.compiling import jit as tracer_jit
from rssnav.kernels.compiling import jit as loop_jit
from rssnav.kernels.learning import fill_greedy


@pytest.fixture
def sources(tmp_path):
    folder = tmp_path / "package" / "kernels"
    folder.mkdir(parents=True)
    for name in ("caller.py", "callee.py"):
        (folder / name).write_text("x = 1\n")
    return folder


@pytest.fixture(autouse=True)
def own_environment(tmp_path, monkeypatch):
    """No folder but those below the test's own, and no memory of earlier ones."""
    monkeypatch.delenv("NUMBA_CACHE_DIR", raising=False)
    monkeypatch.delenv("XDG_CACHE_HOME", raising=False)
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    monkeypatch.setattr(cache.tempfile, "gettempdir", lambda: str(tmp_path))
    cache_folder.cache_clear()
    cache._warn.cache_clear()
    yield
    cache_folder.cache_clear()


@pytest.mark.parametrize("name", ["caller.py", "callee.py", "new.py"])
def test_a_change_in_any_source_changes_the_digest(sources, name) -> None:
    before = sources_digest(sources)
    assert sources_digest(sources) == before
    (sources / name).write_text("x = 2\n")
    assert sources_digest(sources) != before


def test_moving_text_between_sources_changes_the_digest(sources) -> None:
    before = sources_digest(sources)
    (sources / "callee.py").write_text("")
    (sources / "caller.py").write_text("x = 1\nx = 1\n")
    assert sources_digest(sources) != before


@pytest.mark.parametrize(
    ("package", "kernel"), [(raytrace.kernels, grow_tree_arrays), (rssnav.kernels, fill_greedy)]
)
def test_kernels_are_kept_in_the_folder_of_their_sources(package, kernel) -> None:
    assert sources_digest(Path(package.__path__[0])) in str(kernel.stats.cache_path)


@pytest.mark.parametrize("jit", [tracer_jit, loop_jit])
def test_compiling_leaves_the_settings_of_numba_alone(jit, monkeypatch) -> None:
    monkeypatch.setattr(numba.core.config, "CACHE_DIR", "elsewhere")
    jit()(lambda x: x)
    assert numba.core.config.CACHE_DIR == "elsewhere"


def test_folders_are_chosen_in_order(tmp_path, sources, monkeypatch) -> None:
    def chosen() -> Path | None:
        cache_folder.cache_clear()
        return cache_folder(sources)

    name = f"package-{sources_digest(sources)}"
    assert chosen() == tmp_path / "home" / ".cache" / "rssnav" / "kernels" / name
    monkeypatch.setenv("XDG_CACHE_HOME", "")
    assert chosen() == tmp_path / "home" / ".cache" / "rssnav" / "kernels" / name
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "xdg"))
    assert chosen() == tmp_path / "xdg" / "rssnav" / "kernels" / name
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "chosen"))
    assert chosen() == tmp_path / "chosen" / name


def test_without_a_home_the_folder_is_private(tmp_path, sources, monkeypatch) -> None:
    def no_home() -> Path:
        raise RuntimeError("Could not determine home directory.")

    monkeypatch.setattr(Path, "home", no_home)
    folder = cache_folder(sources)
    assert folder is not None
    assert folder.parent.parent == tmp_path
    assert folder.parent.stat().st_mode & 0o777 == 0o700


def test_an_unwritable_folder_is_replaced_and_reported(tmp_path, sources, monkeypatch) -> None:
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "file"))
    with pytest.warns(RuntimeWarning, match="cannot be written: compiled kernels are kept in"):
        folder = cache_folder(sources)
    assert folder is not None
    assert folder.is_relative_to(tmp_path)
    assert not list(sources.glob("**/*.nb?"))


def test_a_relative_folder_is_ignored(tmp_path, sources, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("XDG_CACHE_HOME", "here")
    folder = cache_folder(sources)
    assert folder is not None
    assert folder.is_relative_to(tmp_path / "home" / ".cache")


@pytest.mark.parametrize("trap", ["all may write", "of another user"])
def test_kernels_of_others_are_not_used(tmp_path, sources, monkeypatch, trap) -> None:
    """They are code that runs as this user."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "xdg"))
    folder = cache_folder(sources)
    assert folder is not None
    (folder / "kernel.nbi").write_text("")
    if trap == "all may write":
        folder.chmod(0o777)
    elif os.getuid() == 0:
        os.chown(folder, 12345, -1)
    else:
        pytest.skip("only the administrator can give a folder to another user")
    cache_folder.cache_clear()
    with pytest.warns(RuntimeWarning, match="belongs to others: compiled kernels are kept in"):
        found = cache_folder(sources)
    assert found is not None
    assert found.parent == tmp_path / f"rssnav-{os.getuid()}"


@pytest.mark.skipif(os.getuid() != 0, reason="only the administrator can leave such a folder")
def test_the_administrator_s_kernels_are_used(tmp_path, sources, monkeypatch) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "xdg"))
    folder = cache_folder(sources)
    monkeypatch.setattr(os, "getuid", lambda: 12345)
    cache_folder.cache_clear()
    assert cache_folder(sources) == folder


@pytest.mark.parametrize("trap", ["open", "link", "file"])
def test_a_folder_that_others_may_write_is_not_used(tmp_path, sources, monkeypatch, trap) -> None:
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "file"))
    private = tmp_path / f"rssnav-{os.getuid()}"
    if trap == "open":
        private.mkdir(mode=0o777)
        private.chmod(0o777)
    elif trap == "link":
        (tmp_path / "elsewhere").mkdir(mode=0o700)
        private.symlink_to(tmp_path / "elsewhere")
    else:
        private.write_text("")
    with pytest.warns(RuntimeWarning, match="compiled at every start"):
        assert cache_folder(sources) is None
    assert not (tmp_path / "elsewhere" / "package").exists()


def twice(x: float) -> float:
    return 2.0 * x


def compiled(folder: Path):
    dispatcher = numba.njit(twice)
    dispatcher._cache = KernelCache(twice, folder)
    return dispatcher


@pytest.mark.parametrize("suffix", [".nbi", ".nbc"])
@pytest.mark.parametrize("damage", ["byte", "cut", "empty"])
def test_damaged_files_are_compiled_again(tmp_path, suffix, damage) -> None:
    folder = tmp_path / "kernels"
    folder.mkdir()
    assert compiled(folder)(1.0) == 2.0
    (path,) = folder.glob(f"*{suffix}")
    content = path.read_bytes()
    middle = len(content) // 2
    flipped = content[:middle] + bytes([content[middle] ^ 1]) + content[middle + 1 :]
    path.write_bytes({"byte": flipped, "cut": content[:middle], "empty": b""}[damage])
    kernel = compiled(folder)
    with pytest.warns(RuntimeWarning, match="damaged kernels are compiled again"):
        assert kernel(1.0) == 2.0
    again = compiled(folder)
    assert again(1.0) == 2.0
    assert again.stats.cache_hits, "the damaged file was replaced"


def test_a_folder_that_became_unwritable_is_reported_once(tmp_path) -> None:
    folder = tmp_path / "kernels"
    folder.mkdir()
    kernel = compiled(folder)
    folder.rmdir()
    folder.write_text("no folder")
    with pytest.warns(RuntimeWarning, match="compiled kernels cannot be kept"):
        assert kernel(1.0) == 2.0
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert kernel(1) == 2.0
