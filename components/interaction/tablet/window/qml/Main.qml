import QtQuick
import QtQuick.Window
import Usher.Tablet

Window {
    id: window

    required property ScreenModel model

    width: Theme.designWidth / 2
    height: Theme.designHeight / 2
    title: "MARVIN"
    color: Theme.background

    Kiosk {
        anchors.fill: parent
        model: window.model
    }
}
