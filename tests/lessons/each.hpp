// ALMESH_FOR_EACH_OF(macro, x, a, b, c): macro(x, a) macro(x, b) macro(x, c), for up to 27 words;
// ALMESH_FOR_EACH(macro, a, b, c): macro(a) macro(b) macro(c).
#pragma once
#define ALMESH_FOR_EACH(macro, ...) ALMESH_FOR_EACH_OF(ALMESH_LAST_, macro, __VA_ARGS__)
#define ALMESH_FOR_EACH_OF(macro, of, ...) ALMESH_EXPAND_27_(ALMESH_EACH_(macro, of, __VA_ARGS__))
#define ALMESH_LAST_(macro, word) macro(word)
#define ALMESH_EXPAND_27_(...) ALMESH_EXPAND_9_(ALMESH_EXPAND_9_(ALMESH_EXPAND_9_(__VA_ARGS__)))
#define ALMESH_EXPAND_9_(...) ALMESH_EXPAND_3_(ALMESH_EXPAND_3_(ALMESH_EXPAND_3_(__VA_ARGS__)))
#define ALMESH_EXPAND_3_(...) ALMESH_EXPAND_1_(ALMESH_EXPAND_1_(ALMESH_EXPAND_1_(__VA_ARGS__)))
#define ALMESH_EXPAND_1_(...) __VA_ARGS__
#define ALMESH_EACH_(macro, of, first, ...) \
    macro(of, first) __VA_OPT__(ALMESH_AGAIN_ ALMESH_PARENTHESES_ (macro, of, __VA_ARGS__))
#define ALMESH_AGAIN_() ALMESH_EACH_
#define ALMESH_PARENTHESES_ ()
