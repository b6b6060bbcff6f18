"""From what sessions show to frames and stills: what is drawn next, drawn, encoded and sent."""
