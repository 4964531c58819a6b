# SPDX-License-Identifier: Apache-2.0
"""pages_in_browser_test.py PHYSPRING MAKE_SMALL_TWIN: the pages of `eval` and `diagnose` in a real
browser. They write nothing to the console and ask for nothing, their films play, they fit a
phone, and names are text. Exits with 77 (skipped) where there is no Chromium."""
import pathlib
import subprocess
import sys
import tempfile

from browser import Browser, find_browser

SKIPPED = 77  # CTest's exit status for a test that could not be run
DESK, PHONE = 1200, 390  # CSS pixels

FRAME = 'document.getElementById("frame").value'
PICTURES = '[...document.querySelectorAll("canvas")].map((c) => c.toDataURL()).join()'
# what sticks out of the window, unless something around it scrolls
STICKS_OUT = '''(() => {
  const scrolls = (e) => e && (getComputedStyle(e).overflowX !== 'visible' ||
                               scrolls(e.parentElement));
  return [...document.body.querySelectorAll('*')]
      .filter((e) => e.getBoundingClientRect().right > innerWidth + 1 &&
              !scrolls(e.parentElement))
      .map((e) => e.tagName + '.' + e.className);
})()'''


def expect(holds, claim):
    if not holds:
        sys.exit(f'FAILED: {claim}')


def make_pages(physpring, make_small_twin, folder):
    """Paths of the pages, and the name of a recording that both show."""
    subprocess.run([make_small_twin, folder], check=True)
    twin, swing = folder / 'small.twin.npz', folder / 'swing.npz'
    held = next(folder.glob('*held*.npz'))
    evaluation = folder / 'eval.html'
    quiet = {'check': True, 'stdout': subprocess.DEVNULL, 'stderr': subprocess.DEVNULL}
    subprocess.run([physpring, 'eval', twin, swing, held, '--picture', evaluation], **quiet)
    subprocess.run([physpring, 'diagnose', twin, swing, '--heldout', held, '-o',
                    folder / 'diagnosis'], **quiet)
    return [evaluation, folder / 'diagnosis' / 'report.html'], held.stem


def expect_quiet(browser, page):
    expect(not browser.complaints, f'{page.name} is quiet: {browser.complaints}')


def expect_film_plays(browser, page):
    browser.evaluate('document.getElementById("frame").value = 0;'
                     'document.getElementById("frame").dispatchEvent(new Event("input"))')
    browser.evaluate(f'window.first = {PICTURES}')
    browser.evaluate('document.getElementById("play").click()')
    expect(browser.wait_for(f'{FRAME} !== "0"'), f'the film of {page.name} plays')
    expect(browser.wait_for(f'{PICTURES} !== window.first'), f'the film of {page.name} moves')
    browser.evaluate('document.getElementById("play").click()')


def expect_fits(browser, page, width):
    inner = browser.evaluate('innerWidth')
    expect(inner == width, f'the window is {width} wide, not {inner}')
    wide = browser.evaluate('document.documentElement.scrollWidth')
    expect(wide <= width, f'{page.name} fits {width} pixels: it has {wide}, '
                          f'{browser.evaluate(STICKS_OUT)}')
    out = browser.evaluate(STICKS_OUT)
    expect(not out, f'in {page.name} nothing sticks out at {width} pixels: {out}')


def expect_text(browser, page, name):
    expect(browser.evaluate('document.body.textContent').count(name) > 0,
           f'{page.name} shows the name {name}')


def main(physpring, make_small_twin):
    program = find_browser()
    if not program:
        print('SKIPPED: there is no Chromium')
        return SKIPPED
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as name:
        folder = pathlib.Path(name)
        pages, recording = make_pages(physpring, make_small_twin, folder)
        with Browser(program, folder / 'profile') as browser:
            for page in pages:
                for width in (DESK, PHONE):
                    browser.open(page, width)
                    expect_quiet(browser, page)
                    expect_fits(browser, page, width)
                    expect_film_plays(browser, page)
                    expect_text(browser, page, recording)
                    expect_quiet(browser, page)
    return 0


if __name__ == '__main__':
    sys.exit(main(*sys.argv[1:]))
