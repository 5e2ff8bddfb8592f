# Compiler settings every target of the project shares, and the function that makes a room's library.
include_guard()

find_program(CITYSTREAM_CCACHE ccache)
if(CITYSTREAM_CCACHE)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CITYSTREAM_CCACHE})
endif()
find_program(CITYSTREAM_MOLD mold)
if(CITYSTREAM_MOLD AND NOT CITYSTREAM_FUZZ)
  add_link_options(-fuse-ld=mold)
endif()

add_compile_options(-Wall -Wextra -Wshadow -Wconversion -Wno-sign-conversion -Wnon-virtual-dtor -Werror)
# The two twins of a decoder (CPU, GPU) must round alike, so the compiler may not fuse multiply and add.
add_compile_options(-ffp-contract=off)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # Known false positives of GCC 12 at -O2 in std::vector and std::string.
  add_compile_options(-Wno-stringop-overflow -Wno-array-bounds -Wno-restrict -Wno-maybe-uninitialized)
endif()

set(CITYSTREAM_SANITIZE "" CACHE STRING "Sanitizers for every target: address,undefined or thread")
if(CITYSTREAM_SANITIZE)
  add_compile_options(-fsanitize=${CITYSTREAM_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  add_link_options(-fsanitize=${CITYSTREAM_SANITIZE})
  if(CITYSTREAM_SANITIZE STREQUAL "thread" AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    # GCC warns that fences (Boost.Asio has some) are not understood by the thread sanitizer.
    add_compile_options(-Wno-tsan)
  endif()
endif()

# citystream_room(NAME SOURCES... LIBS...): a static library citystream_NAME of one room of the house.
function(citystream_room name)
  cmake_parse_arguments(ROOM "" "" "SOURCES;LIBS;PRIVATE_LIBS" ${ARGN})
  add_library(citystream_${name} STATIC ${ROOM_SOURCES})
  target_include_directories(citystream_${name} PUBLIC ${CMAKE_SOURCE_DIR})
  target_link_libraries(citystream_${name} PUBLIC ${ROOM_LIBS} PRIVATE ${ROOM_PRIVATE_LIBS})
endfunction()
