# Compiler settings every target of the project shares, and the function that makes a room's library.
include_guard()

find_program(CITYSTREAM_CCACHE ccache)
if(CITYSTREAM_CCACHE)
  # Paths are taken relative to the tree, so that a fresh clone finds what another clone compiled.
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env CCACHE_BASEDIR=${CMAKE_SOURCE_DIR} CCACHE_NOHASHDIR=1 ${CITYSTREAM_CCACHE})
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
  add_compile_options(-Wno-stringop-overflow -Wno-stringop-overread -Wno-array-bounds -Wno-restrict -Wno-maybe-uninitialized)
endif()

set(CITYSTREAM_SANITIZE "" CACHE STRING "Sanitizers for every target: address,undefined or thread")
if(CITYSTREAM_SANITIZE)
  add_compile_options(-fsanitize=${CITYSTREAM_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  add_link_options(-fsanitize=${CITYSTREAM_SANITIZE})
  if(CITYSTREAM_SANITIZE MATCHES "thread")
    # TSan does not understand memory fences, and Asio has some around its handlers. They order nothing that its locks do not order as well.
    # Everywhere, for the one definition rule.
    add_compile_definitions(BOOST_ASIO_DISABLE_FENCED_BLOCK)
    if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
      add_compile_options(-Wno-tsan)
    endif()
  endif()
endif()

if(CITYSTREAM_FUZZ)
  # libFuzzer is guided by which branches of the libraries ran; each fuzz program adds the driver.
  add_compile_options(-fsanitize=fuzzer-no-link)
  # Clang 14 cannot put this check's mark before a coroutine ("difference across sections").
  add_compile_options(-fno-sanitize=function)
endif()

# citystream_uses_coroutines(TARGET): for the code that writes Asio coroutines.
function(citystream_uses_coroutines target)
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    # GCC 12 takes Asio's inlined allocation of a coroutine's frame for a mismatched pair of new and delete.
    target_compile_options(${target} PRIVATE -Wno-mismatched-new-delete)
  endif()
endfunction()

# citystream_room(NAME SOURCES... LIBS...): a static library citystream_NAME of one room of the house.
function(citystream_room name)
  cmake_parse_arguments(ROOM "" "" "SOURCES;LIBS;PRIVATE_LIBS" ${ARGN})
  add_library(citystream_${name} STATIC ${ROOM_SOURCES})
  target_include_directories(citystream_${name} PUBLIC ${CMAKE_SOURCE_DIR})
  target_link_libraries(citystream_${name} PUBLIC ${ROOM_LIBS} PRIVATE ${ROOM_PRIVATE_LIBS})
endfunction()
