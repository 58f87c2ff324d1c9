"""The editor tab: a trial as XML text that is edited by elements."""

from .edit_history import EditHistory
from .editor_desk import EditorDesk
from .element_table import element_table
from .xml_document import XmlDocument, XmlNode

__all__ = ["EditHistory", "EditorDesk", "XmlDocument", "XmlNode", "element_table"]
