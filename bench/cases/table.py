#!/usr/bin/env python3
"""A table of situations that users of other tools reported, with what is expected and what Fascia does.

    bench/cases/table.py PATH_OF_FASCIA [CASES] [--only WORD,...] [--markdown]

CASES is the folder of their inputs (default: FASCIA_CASES, else cases of the data beside the checkout). Ends with 1 when
an outcome is not as expected. Some five minutes on one core; --only takes cases by words of their names.
"""
import os
import pathlib
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).parent))
import curve_cases  # noqa: E402
import fault_cases  # noqa: E402
import mesh_cases  # noqa: E402
import runtime_cases  # noqa: E402
from tool import Bench, Skipped  # noqa: E402


def main():
    words = [word for word in sys.argv[1:] if not word.startswith('--')]
    only = None
    if '--only' in sys.argv:
        only = sys.argv[sys.argv.index('--only') + 1]
        words.remove(only)
    if not words:
        sys.exit(__doc__)
    root = pathlib.Path(__file__).resolve().parents[2]
    cases = pathlib.Path(words[1] if len(words) > 1 else os.environ.get('FASCIA_CASES', root.parent / 'shared/cases'))
    if not cases.is_dir():
        print(f'skipped: {cases} is not there')
        return 0
    failed = 0
    row = '| {} | {} | {} | {} |' if '--markdown' in sys.argv else '{:<44} | {:<58} | {:<4} | {}'
    print(row.format('case', 'expected', 'ok', 'outcome'))
    if '--markdown' in sys.argv:
        print('|---|---|---|---|')
    with tempfile.TemporaryDirectory() as folder:
        bench = Bench(pathlib.Path(words[0]).resolve(), cases, pathlib.Path(folder), root)
        for name, expected, check in [case for part in (curve_cases, mesh_cases, runtime_cases, fault_cases) for case in part.CASES]:
            if only and not any(word in name for word in only.split(',')):
                continue
            try:
                outcome = check(bench) or 'as expected'
                verdict = 'yes'
            except Skipped as why:
                outcome, verdict = f'skipped: {why}', '-'
            except Exception as error:  # whatever it is, the table goes on
                outcome, verdict = f'{type(error).__name__}: {error}', 'NO'
                failed += 1
            print(row.format(name, expected, verdict, ' '.join(str(outcome).split())), flush=True)
    print(f'{failed} not as expected')
    return 1 if failed else 0


if __name__ == '__main__':
    sys.exit(main())
