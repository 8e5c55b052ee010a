"""Extracts error and warning messages from C++ sources. Finds each call of a function that raises or
reports a message, joins its string literals, and replaces each value by an ellipsis.
"""

import re

TOKEN = re.compile(
    r'//[^\n]*|/\*.*?\*/|R"(?P<mark>\w*)\((?:.*?)\)(?P=mark)"|"(?:[^"\\\n]|\\.)*"'
    r"|'(?:[^'\\\n]|\\.)*'|[A-Za-z_]\w*|\d[\w.']*|<<|>>|::|->|.", re.DOTALL)
CALL = re.compile(r"Error|FlightFailure|error_message|(?:add_)?problem_?|warn|warn_throttled|failed|"
                  r"(?:fail|refuse|require|reject|throw|report_fail|fault)\w*")
RETURNS = re.compile(r"find_defect|find_load_error|closedness_error|range_error|what_is_\w+|\w+_reason|\w+_complaint|"
                     r"\w+_key_message")
RULE = re.compile(  # beginning of a rule for a value
    r"(?:an?|above|at|between|from|finite|greater|large|less|more|not|one|positive|zero)\b")
VERB = re.compile(  # a word that occurs in sentences
    r"\b(?:is|are|was|were|has|have|had|must|can|cannot|does|do|may|would|no|not|missing|lost"
    r"|more than|\w{3,}s|go|fail|refuse\w*)\b")
VALUE = "…"
OPENING, CLOSING = "([{", ")]}"


def tokens(text):
    """Returns the tokens of a source without comments, preprocessor lines and blanks."""
    text = re.sub(r"^[ \t]*#.*$", "", text, flags=re.MULTILINE)
    found = (match[0] for match in TOKEN.finditer(text))
    return [token for token in found if not token.isspace() and not token.startswith(("//", "/*"))]


def end_of_group(parts, start):
    """Returns the index of the bracket that closes the one at `start`."""
    depth = 0
    for index in range(start, len(parts)):
        depth += (parts[index] in OPENING) - (parts[index] in CLOSING)
        if depth == 0:
            return index
    return len(parts)


def split(parts, separator):
    """Returns the parts between separators outside brackets."""
    found, depth = [[]], 0
    for token in parts:
        depth += (token in OPENING) - (token in CLOSING)
        if token == separator and depth == 0:
            found.append([])
        else:
            found[-1].append(token)
    return found


def is_literal(token):
    return token.startswith('"')


def unquoted(token):
    return token[1:-1].replace('\\"', '"').replace("\\n", " ").replace("\\\\", "\\")


def text_of(parts):
    """Returns the printed text of an expression: literals unchanged, an ellipsis for each value."""
    terms = split(parts, "+")
    if len(terms) > 1:
        return "".join(text_of(term) for term in terms)
    if len(split(parts, "?")) > 1 and ":" in split(parts, "?")[-1]:
        return choice_of(parts)
    if parts and all(is_literal(token) for token in parts):
        return "".join(unquoted(token) for token in parts)
    if parts[-1:] == [")"] and "(" in parts:
        return call_text(parts)
    if parts and is_literal(parts[0]):  # "text" name: a macro between literals
        return "".join(unquoted(token) if is_literal(token) else VALUE for token in parts)
    return VALUE


def choice_of(parts):
    """Returns both strings of a conditional expression if both operands are strings."""
    last = split(parts, "?")[-1]
    yes, no = text_of(last[:last.index(":")]), text_of(last[last.index(":") + 1:])
    if VALUE in (yes, no) or not yes or not no:
        return VALUE
    return f"{yes}/{no}"


def call_text(parts):
    start = parts.index("(")
    if end_of_group(parts, start) != len(parts) - 1:
        return VALUE
    arguments = split(parts[start + 1:-1], ",")
    name = parts[start - 1] if start else ""
    if name == "format" and arguments and all(map(is_literal, arguments[0])):
        return re.sub(r"\{[^{}]*\}", VALUE, text_of(arguments[0])).replace("{{", "{").replace(
            "}}", "}")
    if name in ("string", "") and len(arguments) == 1:
        return text_of(arguments[0])
    return VALUE


def texts_in(source):
    """Yields the message texts of a source."""
    parts = tokens(source)
    for index, token in enumerate(parts[:-1]):
        is_definition = parts[index - 1] in ("string", ">", "*")
        if is_definition and RETURNS.fullmatch(token) and parts[index + 1] == "(":
            yield from returned(parts, index)
        elif parts[index + 1] in ("(", "{") and CALL.fullmatch(token):
            end = end_of_group(parts, index + 1)
            yield from texts_of_call(split(parts[index + 2:end], ","))
        elif token == "<<" and parts[index - 1] == "message" and parts[index - 2] in ";{})":
            end = parts.index(";", index)
            terms = split(parts[index:end], "<<")[1:]
            yield "".join(text_of(term) for term in terms)


def rule_sentence(rule):
    """Returns a rule for a value as a sentence. Some rules already are sentences."""
    return rule if " must " in rule else f"it must be {rule}"


def texts_of_call(arguments):
    """Returns the strings among a call's arguments. require("width", value, value > 0, "positive")
    prints the field name and the rule; refuse("width", "is missing") prints both."""
    texts = [text_of(argument) for argument in arguments if any(map(is_literal, argument))]
    if len(texts) == 1 and RULE.match(texts[0]) and len(arguments) > 2:
        return [f"{VALUE} is {VALUE}; {rule_sentence(texts[0])}"]
    if len(texts) < 2 or not re.fullmatch(f"{VALUE}?[a-z_.]+", texts[0]):
        return texts
    if RULE.match(texts[-1]):
        return [f"{texts[0]} is {VALUE}; {rule_sentence(texts[-1])}"]
    return [f"{texts[0]}: {text}" for text in texts[1:]]


def returned(parts, index):
    """Returns the strings that the function whose name is at `index` returns."""
    start = end_of_group(parts, index + 1) + 1
    if start >= len(parts) or parts[start] != "{":
        return
    body = parts[start:end_of_group(parts, start)]
    for place, token in enumerate(body):
        if token == "return" and ";" in body[place:]:
            expression = body[place + 1:body.index(";", place)]
            if any(map(is_literal, expression)):
                yield text_of(expression)


def is_message(text):
    """Returns true if a string is a sentence. Names of keys, options and fields are arguments as
    well."""
    words = re.findall(r"[A-Za-z]{2,}", text)
    return " " in text and len(words) >= 3 and ("; " in text or VERB.search(text) is not None)


def messages_in(source):
    """Returns the messages of a source in order, without duplicates: (problem, remedy)."""
    found = {}
    for text in texts_in(source):
        text = re.sub(r"\{\d*(?::[^{}]*)?\}", VALUE, text)  # replacement field of a format string
        text = re.sub(r"\s+", " ", re.sub(f"(?:{VALUE})+", VALUE, text)).strip(" :,")
        if is_message(text):
            problem, _, remedy = text.rpartition("; ")
            found[(problem or remedy, remedy if problem else "")] = None
    return list(found)
