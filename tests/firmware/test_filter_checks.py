"""`gyrodrift.h` under sanitizers with random samples, and under clang-tidy."""

import shutil
import subprocess
from pathlib import Path

import pytest
from c_filter_support import WARNINGS, words, write_header
from firmware_support import HERE, run
from support import quick

SANITIZERS = ("-fsanitize=address,undefined", "-fno-sanitize-recover=all", "-O0", "-g")

C, CPP = "-std=c11", "-x c++ -std=c++11"

RUNS = 200
"""Runs of the fuzz program in a test."""

CHECKS = ",".join(
    [
        "-*",
        *("bugprone-*", "cert-*", "clang-analyzer-*", "performance-*"),
        "-bugprone-implicit-widening-of-multiplication-result",  # an index into a matrix of nine numbers
        "-bugprone-easily-swappable-parameters",  # a time and a rate have one type in C
        "-clang-analyzer-security.insecureAPI.DeprecatedOrUnsafeBufferHandling",  # no board has memset_s
    ]
)


@pytest.mark.parametrize(
    ("compiler", "real"), quick([("gcc", "float"), ("clang", "float"), ("gcc", "double")], ("clang", "float"))
)
def test_random_samples_pass_the_sanitizers(tmp_path: Path, compiler: str, real: str) -> None:
    assert fuzzed(tmp_path, compiler, real) == f"{RUNS} runs\n"


@pytest.mark.parametrize("hypotheses", quick((2, 4, 8)))
def test_any_number_of_hypotheses_passes_the_sanitizers(tmp_path: Path, hypotheses: int) -> None:
    """The arrays of hypotheses have their sizes from it."""
    flag = f"-DGD_RESTLEVEL_HYPOTHESES={hypotheses}"
    assert fuzzed(tmp_path, "gcc", "float", flag) == f"{RUNS} runs\n"


def fuzzed(folder: Path, compiler: str, real: str, *flags: str) -> str:
    """Output of the fuzz program with sanitizers."""
    if shutil.which(compiler) is None:
        pytest.skip(f"there is no {compiler}")
    (folder / "empty.c").write_text("int main(void) { return 0; }\n")
    if subprocess.run([compiler, *SANITIZERS, "empty.c"], cwd=folder, capture_output=True, check=False).returncode:
        pytest.skip(f"{compiler} has no sanitizers: apt-get install libclang-rt-dev")
    write_header(folder)
    source = ("-std=c11", *SANITIZERS, *words("fuzz_filters.c", real), *flags)
    run(compiler, *source, "-o", "fuzz", "-lm", folder=folder)
    return run(folder / "fuzz", "1", str(RUNS))


@pytest.mark.parametrize("language", quick((C, CPP), CPP))
def test_clang_tidy_finds_nothing(tmp_path: Path, language: str) -> None:
    if shutil.which("clang-tidy") is None:
        pytest.skip("there is no clang-tidy: apt-get install clang-tidy")
    write_header(tmp_path)
    checks = (f"--checks={CHECKS}", "--warnings-as-errors=*", "--header-filter=.*", "--quiet")
    source = (str(HERE / "use_filters.c"), "--", *language.split(), *WARNINGS, "-DGD_REAL=float", "-I.")
    assert "warning:" not in run("clang-tidy", *checks, *source, folder=tmp_path)
