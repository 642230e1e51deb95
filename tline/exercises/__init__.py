"""The exercise tline grew out of, letter by letter: friction, lines, passivity of lines, coupled drives."""
