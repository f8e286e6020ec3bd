# The reference of the C++ header, after that of the C header, to which its pages point: doxygen
# docs/Doxyfile.cpp, from the root of the tree; pages in build/docs/html/cpp. What a method does is
# said by the C function that it calls, so that not each has a text of its own.
@INCLUDE               = docs/Doxyfile
PROJECT_NAME           = "packcell for C++"
FILE_PATTERNS          = *.hpp
HTML_OUTPUT            = html/cpp
OPTIMIZE_OUTPUT_FOR_C  = NO
EXTRACT_ALL            = YES
EXCLUDE_SYMBOLS        = *detail*
INLINE_SOURCES         = YES
SOURCE_BROWSER         = YES
TAGFILES               = build/docs/packcell.tag=..
GENERATE_TAGFILE       =
