# `cpack` makes a Debian package that depends on the run-time libraries only.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_CONTACT "The Usher developers <usher@localhost>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY ${PROJECT_DESCRIPTION})
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
# The cascades of face_detector, the models of speech: files that no library asks for.
set(CPACK_DEBIAN_PACKAGE_DEPENDS "opencv-data, pocketsphinx-en-us")
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
include(CPack)
