"""The paper's figures, tables, equations and statements, recomputed."""
