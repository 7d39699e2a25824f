"""What the tests share, and the rule that a check on a clean machine leaves nothing out."""

import os
from pathlib import Path

import pytest
from hypothesis import settings

# a first call may compile, and a busy machine is no fault of the code
settings.register_profile("course", deadline=None)
settings.load_profile("course")


@pytest.fixture(scope="session")
def home() -> Path:
    """The folder of the project."""
    return Path(__file__).parent.parent


def _skipped(config: pytest.Config) -> list[pytest.TestReport]:
    reporter = config.pluginmanager.get_plugin("terminalreporter")
    return list(reporter.stats.get("skipped", [])) if reporter else []


def pytest_sessionfinish(session: pytest.Session) -> None:
    """With CI set in the environment, a skipped test fails the run."""
    if os.environ.get("CI") and _skipped(session.config):
        session.exitstatus = pytest.ExitCode.TESTS_FAILED


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter, config: pytest.Config) -> None:
    """Say in plain words what ran and what did not; the reasons stand above."""
    counts = {name: len(terminalreporter.stats.get(name, [])) for name in ("passed", "failed", "error", "skipped")}
    said = ", ".join(f"{count} {name}" for name, count in counts.items() if count)
    terminalreporter.write_line(f"tests and notebook cells: {said or 'none'}")
    if counts["skipped"] and os.environ.get("CI"):
        terminalreporter.write_line("nothing may be skipped where CI is set: the run fails")
