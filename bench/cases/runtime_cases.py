"""Programs that use the library: locale, floating-point mode, time steps."""
import shutil
import subprocess

from tool import Skipped


def program(bench, name):
    compiler = shutil.which('cc') or shutil.which('gcc')
    library = bench.fascia.parent.parent / 'lib'
    if not compiler or not (library / 'libfascia.so.0').exists():
        raise Skipped('no compiler or no shared library')
    out = bench.out(name)
    subprocess.run([compiler, '-w', '-I', bench.root / 'runtime/include', bench.case(f'24-host-locale-dt-unload/{name}.c'),
                    '-o', out, library / 'libfascia.so.0', '-lm', f'-Wl,-rpath,{library}'], check=True)
    return subprocess.run([out, bench.rig()], check=True, capture_output=True, text=True).stdout.splitlines()


def after_a_pause(bench):
    lines = program(bench, 'after_pause')
    after = [float(word) for word in lines[5].split()]  # half a second, then frames of 1/60 s
    smooth = [float(word) for word in lines[7].split()]  # frames of 1/30 s all along
    assert max(after[1:]) <= max(smooth), f'{max(after[1:]):.1f} mm in a frame after the pause, {max(smooth):.1f} without'
    tiny = [float(word) for word in program(bench, 'slow_motion')[5].split()]
    assert tiny[1] < 0.1, f'a step of 1 ns after the pause moves {tiny[1]} mm'
    return f'1 ns after it {tiny[1]:.2f} mm, 1/60 s {after[1]:.2f} mm, {max(smooth):.1f} mm in a frame of 1/30 s without'


def slow_motion(bench):
    lines = program(bench, 'slow_motion')
    smile = [float(word) for word in lines[1].split()]
    jaw = [float(word) for word in lines[3].split()]
    steps = [max(a, b) / max(min(a, b), 0.02) for a, b in zip(smile, smile[1:])]
    assert max(steps) < 1.6, f'a smile in slow motion jumps by a factor {max(steps):.1f} from frame to frame'
    assert max(jaw) < 1.5, f'a jaw in slow motion moves {max(jaw):.2f} mm in a frame'
    return f'smile changes by a factor {max(steps):.2f} at most from frame to frame, jaw {max(jaw):.2f} mm at most'


def tiny_steps(bench):
    lines = program(bench, 'tiny_dt')
    last = [line for line in lines if line.startswith('dt 1e-09')][0]
    moved = [float(word.strip('!')) for word in last.split(':')[1].split(' mm')[0].split()]
    assert max(moved) < 0.01, f'steps of 1 ns move up to {max(moved)} mm'
    return f'steps of 1 ns move {max(moved):.3f} mm'


CASES = [
    ('24 a frame of half a second', 'what follows moves as without it', after_a_pause),
    ('24 slow motion', 'equal steps', slow_motion),
    ('24 steps of a nanosecond', 'nothing moves', tiny_steps),
]
