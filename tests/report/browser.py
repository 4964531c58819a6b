# SPDX-License-Identifier: Apache-2.0
"""A headless Chromium for tests, driven over a pipe (Chrome DevTools Protocol)."""
import itertools
import json
import os
import select
import shutil
import subprocess
import time

NAMES = ('chromium', 'chromium-browser', 'google-chrome', 'google-chrome-stable')
WORRIES = ('error', 'warning', 'assert')  # kinds of lines on the console


def find_browser():
    """The path of a Chromium; None where there is none."""
    return next(filter(None, map(shutil.which, NAMES)), None)


class Browser:
    """One page at a time. `complaints` has what it wrote to the console as an error or a warning,
    exceptions, and everything it asked for but the page itself."""

    def __init__(self, program, profile):
        to_browser, self.write_end = os.pipe()
        self.read_end, from_browser = os.pipe()

        def place_pipes():  # the browser reads from 3 and writes to 4
            read, write = os.dup(to_browser), os.dup(from_browser)
            os.dup2(read, 3)
            os.dup2(write, 4)

        self.process = subprocess.Popen(
            [program, '--headless=new', '--no-sandbox', '--disable-gpu', '--remote-debugging-pipe',
             '--disable-dev-shm-usage', '--no-first-run', '--disable-extensions',
             '--disable-background-networking', f'--user-data-dir={profile}', 'about:blank'],
            preexec_fn=place_pipes, pass_fds=(3, 4), stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        os.close(to_browser)
        os.close(from_browser)
        self.buffer, self.numbers, self.session = b'', itertools.count(1), None
        self.complaints, self.url, self.loaded = [], None, False
        target = self.call('Target.createTarget', url='about:blank')['targetId']
        attached = self.call('Target.attachToTarget', targetId=target, flatten=True)
        self.session = attached['sessionId']
        for domain in ('Page', 'Runtime', 'Log', 'Network'):
            self.call(domain + '.enable')

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.terminate()
        self.process.wait()
        os.close(self.write_end)
        os.close(self.read_end)

    def call(self, method, **parameters):
        """Sends a command and returns its result."""
        number = next(self.numbers)
        message = {'id': number, 'method': method, 'params': parameters}
        if self.session:
            message['sessionId'] = self.session
        os.write(self.write_end, json.dumps(message).encode() + b'\0')
        while True:
            answer = self.next_message()
            if answer.get('id') == number:
                if 'error' in answer:
                    raise RuntimeError(f'{method}: {answer["error"]}')
                return answer['result']

    def next_message(self, patience=120):
        """The next message; what it complains of is kept."""
        while b'\0' not in self.buffer:
            if not select.select([self.read_end], [], [], patience)[0]:
                raise RuntimeError('the browser does not answer')
            part = os.read(self.read_end, 1 << 20)
            if not part:
                raise RuntimeError('the browser has ended')
            self.buffer += part
        text, self.buffer = self.buffer.split(b'\0', 1)
        message = json.loads(text)
        self.note(message.get('method'), message.get('params', {}))
        return message

    def note(self, event, details):
        if event == 'Page.loadEventFired':
            self.loaded = True
        elif event == 'Runtime.consoleAPICalled' and details['type'] in WORRIES:
            self.complaints.append(f'{details["type"]}: {details["args"]}')
        elif event == 'Runtime.exceptionThrown':
            self.complaints.append(f'exception: {details["exceptionDetails"]}')
        elif event == 'Log.entryAdded' and details['entry']['level'] in ('error', 'warning'):
            self.complaints.append(f'{details["entry"]["level"]}: {details["entry"]["text"]}')
        elif event == 'Network.requestWillBeSent':
            url = details['request']['url']
            if url != self.url and not url.startswith('data:'):
                self.complaints.append(f'asks for {url}')

    def open(self, path, width, height=900):
        """Loads the file in a window of that width, in CSS pixels; forgets complaints so far."""
        self.call('Emulation.setDeviceMetricsOverride', width=width, height=height,
                  deviceScaleFactor=1, mobile=width < 600)
        self.url, self.loaded, self.complaints = path.as_uri(), False, []
        self.call('Page.navigate', url=self.url)
        while not self.loaded:
            self.next_message()

    def evaluate(self, expression):
        """The value of a JavaScript expression."""
        result = self.call('Runtime.evaluate', expression=expression, returnByValue=True)
        if 'exceptionDetails' in result:
            raise RuntimeError(f'{expression}: {result["exceptionDetails"]}')
        return result['result'].get('value')

    def wait_for(self, expression, seconds=30):
        """Whether the expression becomes true in that time."""
        end = time.monotonic() + seconds
        while not self.evaluate(expression):
            if time.monotonic() > end:
                return False
            time.sleep(0.05)
        return True
