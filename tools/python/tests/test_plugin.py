"""The plugin of pytest, run by pytest."""

import pytest

KERNELS = """
import numpy as np
import pytest

def right(colors, opacity, background):
    return colors + (1 - opacity)[:, None] * background

def wrong(colors, opacity, background):
    return colors + background

def back(colors, opacity, background, grad_colors_out):
    return grad_colors_out, -grad_colors_out @ background, ((1 - opacity)[:, None] * grad_colors_out).sum(0)
"""


@pytest.fixture
def run(pytester):
    """Runs tests of this text, with kernels in front."""

    def tests(text, *words, known=None):
        pytester.makepyfile(KERNELS + text)
        if known is not None:
            pytester.makeini("[pytest]\nnerf_oracle_xfail = known.txt\n")
            (pytester.path / "known.txt").write_text(known, encoding="utf-8")
        return pytester.runpytest("-p", "no:cacheprovider", "--strict-markers", "-rA", *words)

    return tests


def test_a_kernel_s_own_parameters_are_arrays(run):
    result = run(
        """
@pytest.mark.nerf_oracle("composite_background", dtype="f64")
def test_it(colors, opacity, background):
    return right(colors, opacity, background)
"""
    )
    result.assert_outcomes(passed=1, skipped=1)
    result.stdout.fnmatch_lines(["PASSED *::test_it?composite_background-forward?", "SKIPPED*numpy has no gradients*"])


def test_a_failure_is_the_diagnosis_without_a_traceback(run):
    result = run(
        """
@pytest.mark.nerf_oracle("composite_background", gradients=False)
def kernel(color, opacity, bg):
    return wrong(color, opacity, bg)
"""
    )
    result.assert_outcomes(failed=1)
    result.stdout.fnmatch_lines(["*consistent with:*", "*to fix:*"])
    result.stdout.no_fnmatch_line("*Traceback*")
    result.stdout.no_fnmatch_line("*Error*")


def test_fixtures_hand_over_kernels_of_several_rows(run):
    result = run(
        """
calls = []

@pytest.fixture(params=["one", "two"])
def kernels(request):
    return {"composite_background": right if request.param == "one" else wrong, "composite_background_vjp": back}

@pytest.mark.nerf_oracle("composite_background")
def test_both(kernels):
    return kernels
"""
    )
    result.assert_outcomes(passed=3, failed=1)


def test_what_is_known_to_fail_may_and_must(run):
    text = "@pytest.mark.nerf_oracle('composite_background', gradients=False)\ndef test_it():\n    return {}\n"
    known = "# a page\n\ncomposite_background forward  blends the other way on purpose # really\n"
    result = run(text.format("wrong"), known=known)
    result.assert_outcomes(xfailed=1)
    result.stdout.fnmatch_lines(["*blends the other way on purpose*"])
    run(text.format("right"), known=known).assert_outcomes(failed=1)


@pytest.mark.parametrize(
    ("line", "says"),
    [
        ("composite_backgroun forward why", "*known.txt:1: found*expected a row, a direction and a reason"),
        ("composite_background backward why", "*expected a direction of composite_background (forward, vjp) and a reason"),
        ("composite_background forward", "*known.txt:1: found*"),
    ],
)
def test_the_page_is_checked(run, line, says):
    result = run("@pytest.mark.nerf_oracle('composite_background')\ndef test_it():\n    return right\n", known=line)
    assert result.ret != 0
    result.stdout.fnmatch_lines([says])


@pytest.mark.parametrize(
    ("mark", "says"),
    [
        ("'composite_backgroun'", "*composite_backgroun: no row of the contract; did you mean composite_background*"),
        ("", "*nerf_oracle: no row*"),
        ("'mse', dtyp='f32'", "*nerf_oracle: no setting 'dtyp'*"),
        ("'mse', dtype='f31'", "*dtype: found 'f31'*"),
    ],
)
def test_a_mark_is_checked(run, mark, says):
    result = run(f"@pytest.mark.nerf_oracle({mark})\ndef test_it():\n    return right\n")
    assert result.ret != 0
    result.stdout.fnmatch_lines([says])


def test_what_is_no_function_is_said(run):
    result = run("@pytest.mark.nerf_oracle('composite_background', gradients=False)\ndef test_it():\n    return 3\n")
    result.assert_outcomes(failed=1)
    result.stdout.fnmatch_lines(["*test_it*returned no function to judge*"])


def test_both_directions_share_one_exam(run):
    text = """
calls = []

def counting(colors, opacity, background):
    calls.append(1)
    return right(colors, opacity, background)

@pytest.mark.nerf_oracle("composite_background")
def test_it():
    return {"composite_background": counting, "composite_background_vjp": back}

@pytest.mark.parametrize("times", [4])
def test_after(times):
    first = len(calls)
    import nerf_oracle
    nerf_oracle.judge(composite_background=counting)
    assert len(calls) == 2 * first
"""
    run(text).assert_outcomes(passed=3)


def test_methods_and_classes(run):
    text = """
class TestIt:
    @pytest.mark.nerf_oracle("composite_background", gradients=False)
    def test_it(self):
        return right
"""
    run(text).assert_outcomes(passed=1)
