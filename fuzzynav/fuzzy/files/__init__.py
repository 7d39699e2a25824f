"""Files of fuzzy systems, and the exchange with scikit-fuzzy.

`disk` opens, limits and saves; `fll` and `fll_writer` know the FuzzyLite Language, `fis` and `fis_writer` MATLAB's
format, `text` what they share; `skfuzzy` exchanges systems with scikit-fuzzy.
"""
