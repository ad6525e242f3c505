import QtQuick
import Usher.Tablet

// Figure 7.2 of the thesis: title, primary buttons, status, secondary buttons. Besides: Stop at the
// lower left of every screen that does not offer it itself, and small buttons beside it.
Item {
    id: kiosk

    required property ScreenModel model
    property bool animate: true
    readonly property double u: Math.min(width / Theme.designWidth, height / Theme.designHeight)
    readonly property double margin: 56 * u
    readonly property bool buttonsPage: model.page <= ScreenModel.Buttons
    readonly property bool mapPage: model.page === ScreenModel.Map || model.page === ScreenModel.Journey

    Rectangle {
        anchors.fill: parent
        color: Theme.background
    }
    Text {
        id: title
        objectName: "title"
        anchors.left: parent.left
        anchors.right: parent.right
        anchors.top: parent.top
        anchors.leftMargin: kiosk.margin
        anchors.rightMargin: kiosk.margin
        anchors.topMargin: (kiosk.mapPage ? 24 : 40) * kiosk.u
        text: kiosk.model.title
        color: Theme.title
        font.pixelSize: Theme.titleSize * kiosk.u
        font.weight: Font.Bold
        lineHeight: 0.95
        wrapMode: Text.WordWrap
        Accessible.role: Accessible.Heading
        Accessible.name: text
    }
    Text {
        id: body
        objectName: "body"
        anchors.left: title.left
        anchors.right: title.right
        anchors.top: title.bottom
        anchors.topMargin: 12 * kiosk.u
        text: kiosk.model.text
        visible: !kiosk.mapPage && text !== "" && text !== kiosk.model.title
        color: Theme.text
        font.pixelSize: Theme.statusSize * kiosk.u
        wrapMode: Text.WordWrap
        Accessible.role: Accessible.StaticText
        Accessible.name: text
    }
    Item {
        id: content
        objectName: "content"
        anchors.left: title.left
        anchors.right: title.right
        anchors.top: body.visible ? body.bottom : title.bottom
        anchors.topMargin: (kiosk.mapPage ? 20 : 36) * kiosk.u
        anchors.bottom: bar.top
        anchors.bottomMargin: (kiosk.mapPage ? 20 : 28) * kiosk.u

        Loader {
            anchors.fill: parent
            active: kiosk.buttonsPage
            visible: active
            sourceComponent: ButtonsPage {
                u: kiosk.u
                model: kiosk.model
            }
        }
        Loader {
            anchors.fill: parent
            active: kiosk.mapPage
            visible: active
            sourceComponent: MapPage {
                u: kiosk.u
                model: kiosk.model
                animate: kiosk.animate
                below: bar.height + content.anchors.bottomMargin
            }
        }
        Loader {
            anchors.fill: parent
            active: kiosk.model.page === ScreenModel.Search
            visible: active
            sourceComponent: SearchPage {
                u: kiosk.u
                model: kiosk.model
            }
        }
    }
    Item {
        id: bar
        anchors.left: title.left
        anchors.right: title.right
        anchors.bottom: statusRow.top
        anchors.bottomMargin: 16 * kiosk.u
        height: Theme.buttonHeight * kiosk.u

        Row {
            anchors.left: parent.left
            spacing: 24 * kiosk.u
            BigButton {
                u: kiosk.u
                buttonId: "tablet:stop"
                label: kiosk.model.stopLabel
                kind: 2
                onPress: true
                visible: kiosk.model.stopOffered
                onClicked: kiosk.model.pressStop()
            }
            BigButton {
                u: kiosk.u
                buttonId: "tablet:start"
                label: kiosk.model.startLabel
                kind: 1
                visible: kiosk.model.startOffered
                active: kiosk.model.startActive
                onClicked: kiosk.model.pressStart()
            }
            ButtonRow {
                u: kiosk.u
                buttons: kiosk.model.service
                textSize: 64 * kiosk.u
                onPressed: buttonId => kiosk.model.press(buttonId)
            }
        }
        ButtonRow {
            anchors.right: parent.right
            visible: !kiosk.mapPage
            u: kiosk.u
            buttons: kiosk.model.secondary
            onPressed: buttonId => kiosk.model.press(buttonId)
        }
    }
    Item {
        id: statusRow
        anchors.left: title.left
        anchors.right: title.right
        anchors.bottom: parent.bottom
        anchors.bottomMargin: 20 * kiosk.u
        height: 96 * kiosk.u

        Text {
            objectName: "status"
            anchors.left: parent.left
            anchors.verticalCenter: parent.verticalCenter
            text: kiosk.model.status
            color: Theme.status
            font.pixelSize: Theme.statusSize * kiosk.u
        }
        Row {
            anchors.right: parent.right
            anchors.verticalCenter: parent.verticalCenter
            spacing: 24 * kiosk.u
            visible: kiosk.model.timeLeft >= 0
            Rectangle {
                objectName: "timeBar"
                anchors.verticalCenter: parent.verticalCenter
                width: 480 * kiosk.u
                height: 28 * kiosk.u
                radius: height / 2
                color: Theme.surface
                Rectangle {
                    width: parent.width * kiosk.model.timeLeftShare
                    height: parent.height
                    radius: height / 2
                    color: Theme.focus
                }
            }
            Text {
                objectName: "timeLeft"
                anchors.verticalCenter: parent.verticalCenter
                text: Math.ceil(kiosk.model.timeLeft) + " s"
                color: Theme.title
                font.pixelSize: Theme.statusSize * kiosk.u
            }
        }
    }
}
