"""Judges a report page without Armada's help: balanced tags, unique ids, nothing fetched from anywhere.

usage: judge_page.py PAGE   prints the ids of its figures, one a line; exits 1 with the reason where it is at fault.
"""

import re
import sys
from html.parser import HTMLParser

VOID = {"meta", "br", "img", "link", "input", "hr"}
FETCHING = {"src", "srcset", "href", "xlink:href", "data", "poster", "action", "background"}


class Judge(HTMLParser):
    def __init__(self):
        super().__init__()
        self.open_tags, self.ids, self.figures = [], set(), []

    def handle_starttag(self, tag, attributes):
        self.look_at(tag, attributes)
        if tag not in VOID:
            self.open_tags.append(tag)

    def handle_startendtag(self, tag, attributes):
        self.look_at(tag, attributes)

    def handle_endtag(self, tag):
        if not self.open_tags or self.open_tags.pop() != tag:
            sys.exit(f"</{tag}> at {self.getpos()} closes nothing")

    def look_at(self, tag, attributes):
        if tag in {"script", "iframe", "object", "embed", "link"}:
            sys.exit(f"<{tag}> at {self.getpos()}")
        for name, value in attributes:
            if name in FETCHING and not value.startswith("#"):
                sys.exit(f"{name}={value} at {self.getpos()} is fetched")
            if name == "id":
                if value in self.ids:
                    sys.exit(f"id {value} at {self.getpos()} is given twice")
                self.ids.add(value)
                if tag == "figure":
                    self.figures.append(value)


page = open(sys.argv[1], encoding="utf-8").read()
for outside in re.findall(r"https?:|//\w+\.\w+|@import|url\((?!#)", page):
    sys.exit(f"refers to the outside: {outside}")
judge = Judge()
judge.feed(page)
if judge.open_tags:
    sys.exit(f"never closed: {judge.open_tags}")
print("\n".join(judge.figures))
