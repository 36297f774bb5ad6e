"""Where something is wrong, whatever the law: instruments against each other, and the equations of motion."""
